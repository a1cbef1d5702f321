" The first colouring, until the language server's: how words split depends on what is defined, which it knows.
if exists('b:current_syntax')
  finish
endif
syntax keyword geotraceKeyword param grid define function curve surface point vector metric geodesic
syntax keyword geotraceFunction sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs id min max
syntax keyword geotraceConstant pi e
" Words of their own only where they stand so: at a declaration's start, as an attribute, behind a set's `@`.
syntax match geotraceKeyword /\v%(^|;)\s*\zs%(solid|light|camera|background)>\ze\s+\a\w*\s*[=(]/
syntax match geotraceAttribute /\v%(^|,)\s*\zs%(color|mirror|glass|ior|depth|diffuse|specular|shininess|bump|uv|radius|power|ambient|falloff|angle|soft|size|fov|focus|aperture|roll|projection|image|bokeh|turn)>\ze\s*:%(\s*\[)@!/
syntax match geotraceFunction /\v\@\s*\zs%(scale|rotate)>\ze\s*[-+0-9.(\[{a-zA-Z]/
syntax match geotraceNumber /\v(\d+\.?\d*|\.\d+)(e[-+]?\d+)?/
syntax match geotraceOperator "[-+*/^_'|\\&]"
syntax match geotraceComment /#.*$/ contains=@Spell
highlight default link geotraceKeyword Keyword
highlight default link geotraceAttribute Identifier
highlight default link geotraceFunction Function
highlight default link geotraceConstant Constant
highlight default link geotraceNumber Number
highlight default link geotraceOperator Operator
highlight default link geotraceComment Comment
let b:current_syntax = 'geotrace'
