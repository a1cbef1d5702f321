" Colours of CRT scripts until the language server answers.
if exists("b:current_syntax")
  finish
endif

syntax keyword crtKeyword Settings Scene Macro scale translate rotate while if else
syntax keyword crtBoolean true false
syntax match crtObject /\<[A-Z][A-Za-z0-9]*\>/
syntax match crtAttribute /\<[a-z][A-Za-z0-9]*\ze\s*->/
syntax match crtFunction /\<[a-z][A-Za-z0-9]*\ze\s*(/
syntax match crtNumber /\<\d\+\(\.\d*\)\?\|\.\d\+/
syntax region crtString start=/"/ skip=/\\./ end=/"/ oneline
syntax match crtComment /--.*$/

highlight default link crtKeyword Keyword
highlight default link crtBoolean Boolean
highlight default link crtObject Type
highlight default link crtAttribute Identifier
highlight default link crtFunction Function
highlight default link crtNumber Number
highlight default link crtString String
highlight default link crtComment Comment

let b:current_syntax = "crt"
