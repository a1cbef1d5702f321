// A grammar for editors that colour and fold by tree-sitter: Neovim, Helix, Zed.
//
// How a word splits (`piv` is `pi v`) and whether a name is a function depend on what is declared above. A grammar without
// names cannot know that: a word is one node here, and `sin x` is a juxtaposition. The language server knows.

const list = (item) => seq(item, repeat(seq(",", item)));

module.exports = grammar({
    name: "geotrace",

    extras: ($) => [/\s/, $.comment],
    word: ($) => $.word,

    rules: {
        program: ($) => repeat($._declaration),

        _declaration: ($) =>
            choice($.param, $.grid, $.define, $.function, $.curve, $.surface, $.point, $.vector, $.metric, $.geodesic),

        param: ($) =>
            seq(
                "param",
                field("name", $.word),
                optional(seq("=", field("value", $._expression))),
                ":",
                list($.interval),
                ";",
            ),
        grid: ($) => seq("grid", field("name", $.word), ":", list($.interval), ";"),
        define: ($) => seq("define", field("name", $.word), "=", field("value", $._expression), ";"),
        function: ($) => seq("function", $._definition, ";"),
        curve: ($) => seq("curve", $._definition, ",", $.domain, ";"),
        surface: ($) => seq("surface", $._definition, ",", $.domain, ";"),
        metric: ($) => seq("metric", $._definition, ",", $.domain, ";"),
        point: ($) => seq("point", field("name", $.word), "=", field("value", $._expression), ";"),
        vector: ($) =>
            seq(
                "vector",
                field("name", $.word),
                "=",
                field("value", $._expression),
                "@",
                field("start", $._expression),
                ";",
            ),
        geodesic: ($) =>
            seq(
                "geodesic",
                field("name", $.word),
                $.parameters,
                ":",
                field("surface", $.word),
                "=",
                choice(
                    seq(field("direction", $._expression), "@", field("start", $._expression)),
                    field("places", $._expression),
                ),
                ",",
                $.domain,
                ";",
            ),

        _definition: ($) => seq(field("name", $.word), $.parameters, "=", field("value", $._expression)),
        parameters: ($) => seq("(", list($.word), ")"),
        domain: ($) => list(seq(field("parameter", $.word), ":", $.interval)),
        interval: ($) => seq("[", $._expression, ",", $._expression, optional(seq(",", $._expression)), "]"),

        _expression: ($) => choice($.sum, $._juxtaposition),
        sum: ($) => prec.left(seq($._expression, choice("+", "-"), $._juxtaposition)),
        _juxtaposition: ($) => choice($.juxtaposition, $._product),
        juxtaposition: ($) => prec.left(seq($._juxtaposition, $._plain_product)),
        _product: ($) => choice($.product, $._unary),
        product: ($) => prec.left(seq($._product, choice("*", "/"), $._unary)),
        // Behind another factor a sign would be a sum.
        _plain_product: ($) => choice(alias($.plain_product, $.product), $._power),
        plain_product: ($) => prec.left(seq($._plain_product, choice("*", "/"), $._unary)),
        _unary: ($) => choice($.unary, $._power),
        unary: ($) => seq(choice("+", "-", "*", "/"), $._unary),
        _power: ($) => choice($.power, $._postfix),
        power: ($) => prec.right(seq($._postfix, "^", $._unary)),
        _postfix: ($) => choice($.call, $.derivative, $.component, $.number, $.word, $.tuple),
        // A value in front of parentheses is a product, which looks the same.
        call: ($) => prec(1, seq(field("function", choice($.word, $.derivative, $.component)), $.tuple)),
        derivative: ($) => seq($._postfix, "'"),
        component: ($) => seq($._postfix, "_", choice($.word, $.number)),
        tuple: ($) =>
            choice(
                seq("(", list($._expression), ")"),
                seq("[", list($._expression), "]"),
                seq("{", list($._expression), "}"),
            ),

        word: () => /[a-zA-Z][a-zA-Z0-9]*/,
        number: () => /([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?/,
        comment: () => token(seq("#", /.*/)),
    },
});
