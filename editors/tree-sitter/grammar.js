// A grammar for editors that colour and fold by tree-sitter: Neovim, Helix, Zed.
//
// How a word splits (`piv` is `pi v`) and whether a name is a function depend on what is declared above. A grammar without
// names cannot know that: a word is one node here, `sin x` is a juxtaposition, and `radius : [0, 1]` is a parameter's
// interval. The language server knows. Words such as `solid` and `scale` are read as keywords only where they can stand.

const list = (item) => seq(item, repeat(seq(",", item)));

module.exports = grammar({
    name: "geotrace",

    extras: ($) => [/\s/, $.comment],
    word: ($) => $.word,

    rules: {
        program: ($) => repeat($._declaration),

        _declaration: ($) =>
            choice(
                $.param,
                $.grid,
                $.define,
                $.function,
                $.curve,
                $.surface,
                $.point,
                $.vector,
                $.metric,
                $.geodesic,
                $.solid,
                $.light,
                $.camera,
                $.background,
            ),

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
        define: ($) => seq("define", $._value, ";"),
        function: ($) => seq("function", $._definition, ";"),
        curve: ($) => seq("curve", $._definition, $._items, ";"),
        surface: ($) => seq("surface", $._definition, $._items, ";"),
        metric: ($) => seq("metric", $._definition, $._items, ";"),
        point: ($) => seq("point", $._value, optional($._items), ";"),
        vector: ($) =>
            seq(
                "vector",
                field("name", $.word),
                "=",
                field("value", $._expression),
                "@",
                field("start", $._expression),
                optional($._items),
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
                $._items,
                ";",
            ),
        solid: ($) =>
            seq(
                "solid",
                choice($._definition, seq(field("name", $.word), "=", field("value", $._set))),
                optional($._items),
                ";",
            ),
        light: ($) =>
            seq(
                "light",
                field("name", $.word),
                "=",
                choice(
                    field("direction", $._expression),
                    seq(optional(field("direction", $._expression)), "@", field("position", $._expression)),
                ),
                optional($._items),
                ";",
            ),
        camera: ($) =>
            seq(
                "camera",
                field("name", $.word),
                "=",
                field("direction", $._expression),
                "@",
                field("position", $._expression),
                optional($._items),
                ";",
            ),
        background: ($) => seq("background", choice($._definition, $._value), optional($._items), ";"),

        _value: ($) => seq(field("name", $.word), "=", field("value", $._expression)),
        _definition: ($) => seq(field("name", $.word), $.parameters, "=", field("value", $._expression)),
        parameters: ($) => seq("(", list($.word), ")"),
        _items: ($) => repeat1(seq(",", choice($.domain, $.attribute))),
        domain: ($) => seq(field("parameter", $.word), ":", $.interval),
        attribute: ($) => seq(field("name", $.word), ":", field("value", $._expression)),
        // Behind an attribute's `:` it may be a vector, which looks the same.
        interval: ($) => prec(1, $._bracketed),
        _bracketed: ($) => seq("[", list($._expression), "]"),

        // Sets of points: `ball \ cube & (rod | ring) @ scale 2 @ (1, 0, 0)`.
        _set: ($) => choice($.union, $.difference, $._meet),
        union: ($) => prec.left(seq($._set, "|", $._meet)),
        difference: ($) => prec.left(seq($._set, "\\", $._meet)),
        _meet: ($) => choice($.intersection, $._put),
        intersection: ($) => prec.left(seq($._meet, "&", $._put)),
        _put: ($) => choice($.placed, $._atom),
        placed: ($) => prec.left(seq($._put, "@", choice($.map, field("place", $._expression)))),
        // A declared name is written alone.
        map: ($) => seq(choice("scale", "rotate"), optional($._argument)),
        _argument: ($) => choice($._unary, alias($.application, $.juxtaposition)),
        // A function without parentheses: `scale sqrt 2`.
        application: ($) => seq(choice($.word, $.derivative, $.component, $.power), $._argument),
        _atom: ($) => choice($.word, $.group),
        group: ($) => choice(seq("(", $._set, ")"), seq("[", $._set, "]"), seq("{", $._set, "}")),

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
                $._bracketed,
                seq("{", list($._expression), "}"),
            ),

        word: () => /[a-zA-Z][a-zA-Z0-9]*/,
        number: () => /([0-9]+(\.[0-9]*)?|\.[0-9]+)(e[+-]?[0-9]+)?/,
        comment: () => token(seq("#", /[^\r\n]*/)),
    },
});
