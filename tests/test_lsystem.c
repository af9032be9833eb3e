/* L-systems: rewriting against strings derived by hand, what is refused, the turtle against
 * geometry, and the counts of the grammars that come with treeline. */
#include "testing.h"

#include "base/file.h"
#include "plant/lsystem.h"
#include "plant/plant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int setup(void **state)
{
    *state = arena_create(0);
    return 0;
}

static int teardown(void **state)
{
    arena_destroy(*state);
    return 0;
}

static struct lsystem *grammar(struct arena *arena, const char *text)
{
    struct error error = {STATUS_OK, ""};
    struct lsystem *lsystem = NULL;
    if (lsystem_parse(arena, text, "test.json", &lsystem, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return lsystem;
}

static const char *derived(struct arena *arena, const char *text, const char *options)
{
    struct error error = {STATUS_OK, ""};
    struct lsystem *lsystem = grammar(arena, text);
    char *modules = NULL;
    assert_int_equal(lsystem_set(lsystem, options, NULL), STATUS_OK);
    if (lsystem_text(arena, lsystem, &modules, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    return modules;
}

static const char pairs[] =
    "{\"parameters\": [{\"name\": \"n\", \"value\": 2, \"minimum\": 0, \"maximum\": 9, "
    "\"whole\": true}, {\"name\": \"q\", \"value\": 0.5, \"minimum\": 0, \"maximum\": 1}],"
    "\"axiom\": \"A(1, 0)\", \"rules\": ["
    "{\"of\": \"A(l, k)\", \"when\": \"k < n\", \"to\": \"F(l, 1, q) [+(30) A(l * q, k + 1)] "
    "-(2 * 15) A(l - 0.25, k + 1)\"},"
    "{\"of\": \"A(l, k)\", \"when\": \"k == n\", \"to\": \"f(l) Leaf\"},"
    "{\"of\": \"Leaf\", \"when\": \"0\", \"to\": \"\"}]}";

static void test_rewriting__gives_the_string_derived_by_hand(void **state)
{
    /* A(1,0) => F(1)[+A(.5,1)]-A(.75,1) => ..., each A once more, then leaves. */
    assert_string_equal(derived(*state, pairs, NULL),
                        "F(1,1,0.5)[+(30)F(0.5,1,0.5)[+(30)f(0.25)Leaf]-(30)f(0.25)Leaf]"
                        "-(30)F(0.75,1,0.5)[+(30)f(0.375)Leaf]-(30)f(0.5)Leaf");
    assert_string_equal(derived(*state, pairs, "n=1,q=1"),
                        "F(1,1,1)[+(30)f(1)Leaf]-(30)f(0.75)Leaf");
    assert_string_equal(derived(*state, pairs, "n=0"), "f(1)Leaf");
}

static void test_expressions__bind_and_compute_as_in_arithmetic(void **state)
{
    static const struct {
        const char *text, *value;
    } rows[] = {
        {"1 + 2 * 3 - 4 / 8", "f(6.5)"},
        {"(1 + 2) * 3", "f(9)"},
        {"7 - 2 - 1", "f(4)"},
        {"-2 * -3", "f(6)"},
        {"7 % 3 + -1 % 3", "f(3)"},
        {"1 < 2 && 2 <= 2", "f(1)"},
        {"1 > 2 || 3 != 3", "f(0)"},
        {"!(4 >= 5) + (5 == 5)", "f(2)"},
        {"2 < 1 + 2", "f(1)"},
        {"if(1 < 2, 10, 20) + if(0, 1, 2)", "f(12)"},
        {"min(3, 2) + max(3, 2)", "f(5)"},
        {"floor(2.9) + abs(-3) + sqrt(16)", "f(9)"},
        {"1e2 + .5", "f(100.5)"},
        {"random(3, 3)", "f(3)"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        char text[160];
        snprintf(text, sizeof text, "{\"axiom\": \"f(%s)\"}", rows[k].text);
        assert_string_equal(derived(*state, text, NULL), rows[k].value);
    }
    assert_float_equal(atof(derived(*state, "{\"axiom\": \"f(sin(30))\"}", NULL) + 2), 0.5, 1e-9);
    assert_float_equal(atof(derived(*state, "{\"axiom\": \"f(cos(60))\"}", NULL) + 2), 0.5, 1e-9);
}

static void test_stochastic__rules_are_drawn_by_weight_and_by_seed(void **state)
{
    static const char text[] =
        "{\"axiom\": \"A(0)\", \"rules\": ["
        "{\"of\": \"A(i)\", \"when\": \"i < 900\", \"weight\": 3, \"to\": \"f(1)A(i + 1)\"},"
        "{\"of\": \"A(i)\", \"when\": \"i < 900\", \"weight\": 1, \"to\": \"f(2)A(i + 1)\"},"
        "{\"of\": \"A(i)\", \"when\": \"i < 900\", \"weight\": 0, \"to\": \"f(3)A(i + 1)\"},"
        "{\"of\": \"A(i)\", \"when\": \"i >= 900\", \"to\": \"\"}]}";
    const char *one = derived(*state, text, "seed=1"), *two = derived(*state, text, "seed=2");
    assert_string_equal(one, derived(*state, text, NULL));
    assert_string_not_equal(one, two);
    double second = 0;
    for (const char *at = one; *at; at += 4) {
        assert_true(at[2] == '1' || at[2] == '2');
        second += at[2] == '2';
    }
    assert_int_equal(strlen(one), 900 * 4);
    assert_float_equal(second / 900, 0.25, 4 * sqrt(0.25 * 0.75 / 900));
    assert_string_equal(derived(*state,
                                "{\"axiom\": \"A\", \"rules\": ["
                                "{\"of\": \"A\", \"weight\": 0, \"to\": \"f(1)\"}]}",
                                NULL),
                        "A");
}

static void refused(struct arena *arena, const char *text, const char *words)
{
    struct error error = {STATUS_OK, ""};
    struct lsystem *lsystem = NULL;
    struct conifer *conifer = NULL;
    enum status status = lsystem_parse(arena, text, "test.json", &lsystem, &error);
    if (status == STATUS_OK)
        status = lsystem_conifer(arena, lsystem, &conifer, &error);
    assert_int_equal(status, STATUS_INVALID);
    if (!strstr(error.text, words) || !strstr(error.text, "test.json"))
        fail_msg("'%s' does not say '%s' and the file", error.text, words);
}

#define RULE(of, to) "{\"of\": \"" of "\", \"to\": \"" to "\"}"
#define GRAMMAR(axiom, rules) "{\"axiom\": \"" axiom "\", \"rules\": [" rules "]}"

static void test_grammar__that_does_not_end_or_explodes_is_refused(void **state)
{
    refused(*state, GRAMMAR("A", RULE("A", "A")), "rules still match after 1000 steps");
    refused(*state, GRAMMAR("A", RULE("A", "A A")), "more than 1048576 modules at step");
    refused(*state,
            GRAMMAR("A", RULE("A", "A f(1) f(1) f(1) f(1) f(1) f(1) B") "," RULE(
                             "B", "B C") "," RULE("C", "B")),
            "more than");
    refused(*state, GRAMMAR("F(1,1,1) T(1,1,1e6,1e6,1,1,1,1,1)", ""), "more than 16777216 needles");
    refused(*state, GRAMMAR("A(1)", RULE("A(x)", "A(x / 0)")),
            "A: argument 1 of module 1 is infinite at step 1");
    refused(*state, GRAMMAR("f(0 / 0)", ""),
            "axiom: argument 1 of module 1 is no number at step 0");
    refused(*state,
            "{\"axiom\": \"A\", \"rules\": [{\"of\": \"A\", \"when\": \"0 / 0\", \"to\": \"\"}]}",
            "A: the condition of its rule 1 is no number at step 1");
}

/* What takes long without writing much: a hundred conditions of three operations, of which none
 * holds, for each of 2^(step - 1) modules. */
static void test_grammar__whose_conditions_take_too_long_is_refused(void **state)
{
    enum { CONDITIONS = 100, SIZE = 1 << 16 };
    char *text = arena_alloc(*state, SIZE, 1);
    size_t used = (size_t)snprintf(text, SIZE,
                                   "{\"axiom\": \"A(0)\", \"rules\": ["
                                   "{\"of\": \"A(i)\", \"when\": \"i < 18\", \"to\": \"A(i + 1) "
                                   "A(i + 1)\"}");
    for (int k = 0; k < CONDITIONS; k++)
        used += (size_t)snprintf(text + used, SIZE - used,
                                 ", {\"of\": \"A(i)\", \"when\": \"i > 18\", \"to\": \"\"}");
    snprintf(text + used, SIZE - used, "]}");
    refused(*state, text, "more than 67108864 operations of expressions at step 18");
}

static void test_grammar__that_is_wrong_is_refused_by_name(void **state)
{
    refused(*state, GRAMMAR("A", ""), "axiom: 'A' is no symbol and has no rule");
    refused(*state, GRAMMAR("F(1, 2)", ""), "has 2 arguments; allowed: 3");
    refused(*state, GRAMMAR("f(1", ""), "')' is missing");
    refused(*state, GRAMMAR("f(1 2)", ""), "an operator is missing");
    refused(*state, GRAMMAR("f(x)", ""), "no such name near 'x)'");
    refused(*state, GRAMMAR("f(tan(1))", ""), "no such function");
    refused(*state, GRAMMAR("f(1) ] [", ""), "brackets do not pair");
    refused(*state, GRAMMAR("[f(1)", ""), "brackets do not pair");
    refused(*state, GRAMMAR("f(1)", RULE("F(l)", "")), "rules[0].of");
    refused(*state, GRAMMAR("A(1)", RULE("A(l)", "") "," RULE("A", "")), "1 arguments, as before");
    refused(*state, GRAMMAR("A(1, 2)", RULE("A(l, l)", "")), "rules[0].of");
    refused(*state, GRAMMAR("F(1, 1e-9, 1)", ""), "a branch's radius is 1e-09");
    refused(*state, "{\"axiom\": \"f(1)\", \"rulez\": []}", "rulez");
    refused(*state, GRAMMAR("f(((((((((((((((((((((((((((((((1)))))))))))))))))))))))))))))))", ""),
            "too deep");
    refused(*state, GRAMMAR("T(1,1,1,1,1,1,1,1,1)", ""), "a twig stands on no branch");
    refused(*state, GRAMMAR("F(-1,1,1)", ""), "a branch's length is -1");
    refused(*state, GRAMMAR("F(1,1,1) T(1,1,1,1,1,1,190,1,1)", ""), "a needle's angle is 190");
    refused(*state, GRAMMAR("f(1)", ""), "0 branches");
}

static void assert_point(const float got[3], double x, double y, double z)
{
    assert_float_equal(got[0], x, 1e-6);
    assert_float_equal(got[1], y, 1e-6);
    assert_float_equal(got[2], z, 1e-6);
}

static void test_turtle__draws_where_geometry_says(void **state)
{
    struct conifer *c = NULL;
    /* Up, then a step to each side of its frame: left is +x, up is -z, heading +y. */
    struct lsystem *l =
        grammar(*state, GRAMMAR("F(2,1,0.5) [+(90) F(1,1,1)] [-(90) F(1,1,1)] [^(90)"
                                " F(1,1,1)] [&(90) F(1,1,1)] [/(90) +(90) F(1,1,1)]"
                                " f(3) F(1,1,1)",
                                ""));
    assert_int_equal(lsystem_conifer(*state, l, &c, NULL), STATUS_OK);
    assert_int_equal(c->branches_count, 7);
    assert_point(c->branches[0].to_m, 0, 2, 0);
    assert_float_equal(c->branches[0].radius_to_m, 0.5, 0);
    assert_point(c->branches[1].to_m, 1, 2, 0);
    assert_point(c->branches[2].to_m, -1, 2, 0);
    assert_point(c->branches[3].to_m, 0, 2, -1);
    assert_point(c->branches[4].to_m, 0, 2, 1);
    assert_point(c->branches[5].to_m, 0, 2, -1);
    assert_point(c->branches[6].from_m, 0, 5, 0);
    /* $ makes left level: up is then as high as it can be, whatever was rolled before. */
    l = grammar(*state, GRAMMAR("&(60) /(77) $ ^(30) F(1,1,1) T(0.5,0.1,5,3,1,1,60,90,10)", ""));
    assert_int_equal(lsystem_conifer(*state, l, &c, NULL), STATUS_OK);
    assert_point(c->branches[0].to_m, 0, sqrt(3) / 2, 0.5);
    assert_int_equal(c->twigs_count, 1);
    assert_point(c->twigs[0].base_m, 0, sqrt(3) / 2, 0.5);
    assert_point(c->twigs[0].axis, 0, sqrt(3) / 2, 0.5);
    assert_float_equal(c->twigs[0].spacing_m, 0.1, 1e-7);
    assert_float_equal(c->twigs[0].needle_angle_rad, 1.04719755, 1e-6);
    assert_int_equal(c->needles_count, 15);
}

static void test_turtle__gives_each_twig_to_the_branch_it_stands_on(void **state)
{
    struct conifer *c = NULL;
    struct lsystem *l = grammar(
        *state, GRAMMAR("F(1,1,1) [+(50) F(2,1,1) T(1,1,2,1,1,1,1,1,1)] T(1,1,3,1,1,1,1,1,1)"
                        " [F(3,1,1)] T(1,1,4,1,1,1,1,1,1)",
                        ""));
    assert_int_equal(lsystem_conifer(*state, l, &c, NULL), STATUS_OK);
    assert_int_equal(c->branches[0].first_twig, 0);
    assert_int_equal(c->branches[0].twigs_count, 2);
    assert_int_equal(c->branches[1].twigs_count, 1);
    assert_int_equal(c->branches[2].twigs_count, 0);
    assert_int_equal(c->twigs[0].cones_count, 3);
    assert_int_equal(c->twigs[1].cones_count, 4);
    assert_int_equal(c->twigs[2].cones_count, 2);
}

/* A grammar of scenes/plants with parameters, and its needles. */
static const struct conifer *grown(struct arena *arena, const char *name, const char *options)
{
    struct error error = {STATUS_OK, ""};
    struct plant *plant = NULL;
    const struct conifer *conifer = NULL;
    const char *path = arena_printf(arena, "%s/scenes/plants/%s.json", data_folder(), name);
    if (plant_lsystem(arena, path, options, &plant, &error) != STATUS_OK ||
        plant_conifer(plant, &conifer, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    const struct conifer *again = NULL;
    assert_int_equal(plant_conifer(plant, &again, NULL), STATUS_OK);
    assert_ptr_equal(again, conifer);
    return conifer;
}

static void test_grammars__have_the_needles_of_the_paper_and_of_their_own_products(void **state)
{
    /* branches x cones x needles; the paper prints 3840 for 24 x 8 x 16. */
    assert_int_equal(grown(*state, "pine-simple", NULL)->needles_count, 2048);
    assert_int_equal(grown(*state, "pine-simple", "needles=20")->needles_count, 2560);
    assert_int_equal(grown(*state, "pine-simple", "branches=24")->needles_count, 3072);
    assert_int_equal(grown(*state, "pine-simple", "branches=24,needles=20")->needles_count, 3840);
    /* Each branch of the first order bears its side branches and a tip. */
    const struct conifer *c =
        grown(*state, "pine-complex", "branches=6,side_branches=4,cones=3,needles=7");
    assert_int_equal(c->needles_count, 6 * (4 + 1) * 3 * 7);
    c = grown(*state, "spruce", "whorls=5,boughs=3,pairs=2,cones=4,needles=6");
    /* Two pairs at least; each twig but the tree's tip has two shoots of half its cones. */
    assert_int_equal(c->needles_count, (5 * 3 * (2 * 2 + 1) * (4 + 2 * 2) + 4) * 6);
    c = grown(*state, "spruce", "whorls=4,boughs=1,pairs=8,cones=2,needles=1");
    assert_int_equal(c->needles_count, (2 * (10 + 8 + 6 + 4) + 4) * (2 + 2 * 1) + 2);
    c = grown(*state, "larch", "boughs=9,pairs=3,cones=2,needles=5,seed=7");
    assert_int_equal(c->needles_count, (9 * (2 * 3 + 1) + 1) * 2 * 5);
}

static void test_parameters__set_the_plant_and_its_hash(void **state)
{
    struct error error = {STATUS_OK, ""};
    const char *path = arena_printf(*state, "%s/scenes/plants/spruce.json", data_folder());
    static const char *const options[] = {NULL, "height=3", "seed=2", "needle_angle=40"};
    uint64_t hashes[4] = {0};
    for (size_t k = 0; k < 4; k++) {
        struct plant *plant = NULL;
        assert_int_equal(plant_lsystem(*state, path, options[k], &plant, NULL), STATUS_OK);
        assert_int_equal(plant_hash(plant, &hashes[k], NULL), STATUS_OK);
        for (size_t i = 0; i < k; i++)
            assert_true(hashes[i] != hashes[k]);
    }
    const struct conifer *c = grown(*state, "spruce", "height=3,width=1,whorls=6");
    assert_true(c->maximum_m[1] > 2.9f && c->maximum_m[1] < 3.4f);
    assert_true(c->maximum_m[0] < 1 && c->minimum_m[0] > -1);
    struct plant *plant = NULL;
    assert_int_equal(plant_lsystem(*state, path, "height=-1", &plant, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "height: '-1' is outside 0.5..60"));
    assert_int_equal(plant_lsystem(*state, path, "hight=2", &plant, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "no option 'hight'"));
    struct lsystem *lsystem = NULL;
    assert_int_equal(lsystem_load(*state, path, &lsystem, NULL), STATUS_OK);
    assert_string_equal(lsystem_options(lsystem)[0].name, "height");
}

/* clang-format off */
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_rewriting__gives_the_string_derived_by_hand, setup, teardown),
        cmocka_unit_test_setup_teardown(test_expressions__bind_and_compute_as_in_arithmetic, setup, teardown),
        cmocka_unit_test_setup_teardown(test_stochastic__rules_are_drawn_by_weight_and_by_seed, setup, teardown),
        cmocka_unit_test_setup_teardown(test_grammar__that_does_not_end_or_explodes_is_refused, setup, teardown),
        cmocka_unit_test_setup_teardown(test_grammar__whose_conditions_take_too_long_is_refused, setup, teardown),
        cmocka_unit_test_setup_teardown(test_grammar__that_is_wrong_is_refused_by_name, setup, teardown),
        cmocka_unit_test_setup_teardown(test_turtle__draws_where_geometry_says, setup, teardown),
        cmocka_unit_test_setup_teardown(test_turtle__gives_each_twig_to_the_branch_it_stands_on, setup, teardown),
        cmocka_unit_test_setup_teardown(test_grammars__have_the_needles_of_the_paper_and_of_their_own_products, setup, teardown),
        cmocka_unit_test_setup_teardown(test_parameters__set_the_plant_and_its_hash, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
