" The first colouring, until the language server's: how words split depends on what is defined, which it knows.
if exists('b:current_syntax')
  finish
endif
syntax keyword geotraceKeyword param grid define function curve surface point vector metric geodesic
syntax keyword geotraceFunction sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs id min max
syntax keyword geotraceConstant pi e
syntax match geotraceNumber /\v(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?/
syntax match geotraceOperator "[-+*/^_']"
syntax match geotraceComment /#.*$/ contains=@Spell
highlight default link geotraceKeyword Keyword
highlight default link geotraceFunction Function
highlight default link geotraceConstant Constant
highlight default link geotraceNumber Number
highlight default link geotraceOperator Operator
highlight default link geotraceComment Comment
let b:current_syntax = 'geotrace'
