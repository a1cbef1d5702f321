["param" "grid" "define" "function" "curve" "surface" "point" "vector" "metric" "geodesic"] @keyword
["solid" "light" "camera" "background"] @keyword
["scale" "rotate"] @function.builtin

(param name: (word) @constant)
(grid name: (word) @constant)
(define name: (word) @constant)
(function name: (word) @function)
(curve name: (word) @function)
(surface name: (word) @type)
(metric name: (word) @type)
(geodesic name: (word) @function)
(geodesic surface: (word) @type)
(point name: (word) @variable)
(vector name: (word) @variable)
(parameters (word) @variable.parameter)
(domain parameter: (word) @variable.parameter)
(solid name: (word) @type)
(light name: (word) @variable)
(camera name: (word) @variable)
(background name: (word) @variable)
(attribute name: (word) @property)
(call function: (word) @function.call)

((word) @function.builtin
  (#any-of? @function.builtin "sin" "cos" "tan" "asin" "acos" "atan" "sinh" "cosh" "tanh" "exp" "log" "sqrt" "abs" "id" "min" "max"))
((word) @constant.builtin (#any-of? @constant.builtin "pi" "e"))

(number) @number
(comment) @comment
["+" "-" "*" "/" "^" "'" "_" "=" "@" "|" "\\" "&"] @operator
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
["," ";" ":"] @punctuation.delimiter
