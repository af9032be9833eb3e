/* wall/json: strict reading with places in messages; writing that reads back. */
#include "testing.h"

#include "wall/json.h"
#include "wall/json_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct arena *arena;

static int start(void **unused)
{
    (void)unused;
    arena = arena_create(0);
    return 0;
}

static int finish(void **unused)
{
    (void)unused;
    arena_destroy(arena);
    return 0;
}

/* A small loader as every room writes it. */
static enum status load(const char *text, struct error *error)
{
    struct json_doc *doc = json_parse(arena, text, "f.json", error);
    if (!doc)
        return error->status;
    struct json *root = json_root(doc);
    float vector[3] = {0};
    json_number(root, "height_m", 20, 0.1, 200);
    json_integer(root, "trees", 1, 0, 1000);
    json_bool(root, "fog", false);
    json_text(root, "doc", NULL);
    json_word(root, "kind", "still|orbit", 0);
    json_vector(root, "eye", vector, 3, -10, 10);
    struct json *sun = json_object(root, "sun");
    json_number(sun, "elevation", NAN, -90, 90);
    for (size_t i = 0; i < json_array(root, "keys"); i++)
        json_integer(json_element(root, "keys", i), "t", -1, 0, 9);
    for (size_t i = 0; i < json_array(root, "list"); i++)
        json_element_number(root, "list", i, 0, 5);
    return json_end(doc);
}

static void test_json__a_good_document_loads(void **unused)
{
    (void)unused;
    struct error error;
    assert_int_equal(load("{}", &error), STATUS_OK);
    assert_int_equal(
        load("{\"height_m\":3,\"trees\":5,\"fog\":true,\"doc\":\"x\",\"kind\":\"orbit\","
             "\"eye\":[1,2,3],\"sun\":{\"elevation\":4},\"keys\":[{\"t\":1}],"
             "\"list\":[1,2],\"trees\":null}",
             &error),
        STATUS_INVALID); /* trees twice */
    assert_int_equal(load("{\"height_m\":null,\"sun\":{\"elevation\":4},\"list\":[]}", &error),
                     STATUS_OK);
}

static void test_json__errors_name_file_place_value_and_allowance(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"{\"height_m\":900}", "f.json: height_m: value is 900; allowed: 0.1..200"},
        {"{\"height_m\":\"x\"}", "f.json: height_m: is a text; allowed: a number"},
        {"{\"trees\":1.5}", "f.json: trees: value is 1.5; allowed: whole numbers 0..1000"},
        {"{\"hieght_m\":1}",
         "f.json: hieght_m: is not a key known here (did you mean 'height_m'?); allowed: height_m, "
         "trees, fog, doc, kind, eye, sun, keys, list"},
        {"{\"sun\":{\"elevaton\":1,\"elevation\":1}}",
         "f.json: sun.elevaton: is not a key known here (did you mean 'elevation'?); allowed: "
         "elevation"},
        {"{\"sun\":{}}", "f.json: sun.elevation: is missing; a number is required"},
        {"{\"keys\":[{\"t\":1},{\"t\":12}]}", "f.json: keys[1].t: value is 12; allowed: 0..9"},
        {"{\"keys\":[3]}", "f.json: keys[0]: is a number; allowed: an object"},
        {"{\"list\":[1,\"x\"]}", "f.json: list[1]: is a text; allowed: a number"},
        {"{\"kind\":\"fly\"}", "f.json: kind: value is 'fly'; allowed: still|orbit"},
        {"{\"kind\":\"orb\"}", "f.json: kind: value is 'orb'; allowed: still|orbit"},
        {"{\"eye\":[1,2]}", "f.json: eye: has 2 values; allowed: 3"},
        {"{\"eye\":[1,2,30]}", "f.json: eye[2]: value is 30; allowed: -10..10"},
        {"{\"trees\":1,\"trees\":2}", "f.json: trees: stands here twice"},
        {"{\"trees\":1e999}", "f.json: trees: is too large a number"},
        {"[]", "f.json: is not an object"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct error error = {0};
        assert_int_equal(load(cases[i].text, &error), STATUS_INVALID);
        assert_string_equal(error.text, cases[i].message);
    }
}

static void test_json__broken_text_names_the_line(void **unused)
{
    (void)unused;
    struct error error = {0};
    assert_int_equal(load("{\n\"trees\": 1,\n oops }", &error), STATUS_INVALID);
    assert_memory_equal(error.text, "f.json:3: not JSON near '", 25);
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"", "f.json: is empty"},
        {" \r\n", "f.json: is empty"},
        {"{} trailing", "f.json:1: not JSON near 'trailing'"},
        {"{\n\"doc\": \"caf\xe9\"}", "f.json:2: not JSON: a byte that is not UTF-8"},
        {"{\"doc\": \"\\\xe9\"}", "f.json:1: not JSON: a byte that is not UTF-8"},
        {"{\"doc\": \"a\\u0000b\"}", "f.json:1: a text holds \\u0000"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(load(cases[i].text, &error), STATUS_INVALID);
        if (strncmp(error.text, cases[i].says, strlen(cases[i].says)) != 0)
            fail_msg("'%s' does not begin with '%s'", error.text, cases[i].says);
    }
}

static void test_json__deep_nesting_is_refused(void **unused)
{
    (void)unused;
    struct error error = {0};
    char text[1024] = "{\"list\":";
    size_t at = strlen(text);
    memset(text + at, '[', 100);
    memset(text + at + 100, ']', 100);
    strcpy(text + at + 200, "}");
    assert_int_equal(load(text, &error), STATUS_INVALID);
    assert_non_null(strstr(error.text, "nested deeper than 64"));
    char *abyss = calloc(1, 100001);
    memset(abyss, '[', 100000);
    assert_int_equal(load(abyss, &error), STATUS_INVALID);
    assert_string_equal(error.text, "f.json:1: is nested deeper than 64 levels");
    free(abyss);
    struct json_doc *doc =
        json_parse(arena, "{\"a\": \"[[\\\"{{{\", \"b\": [[]]}", "f.json", &error);
    assert_non_null(doc); /* brackets in a text nest nothing */
    assert_string_equal(json_text(json_root(doc), "a", ""), "[[\"{{{");
}

/* Every scalar value has one encoding, and nothing else is taken: their number says so. */
static void test_json__utf8_is_what_rfc_3629_says(void **unused)
{
    (void)unused;
    size_t taken[5] = {0};
    for (unsigned first = 1; first < 256; first++)
        for (unsigned second = 1; second < 256; second++)
            for (unsigned third = 1; third < 256; third++) {
                char text[5] = {(char)first, (char)second, (char)third, (char)0xbf, 0};
                size_t length = utf8_length(text);
                assert_true(length <= 4);
                taken[length] += length == 3 || length == 4 || third == 1;
            }
    assert_int_equal(taken[1], 127 * 255);               /* any byte may follow */
    assert_int_equal(taken[2], 0x800 - 0x80);            /* U+0080.. */
    assert_int_equal(taken[3], 0x10000 - 0x800 - 0x800); /* U+0800.. without surrogates */
    assert_int_equal(taken[4], 0x100000 / 64);           /* U+10000.., of one last byte */
    assert_int_equal(utf8_length("\xe2\x82"), 0);
    assert_int_equal(utf8_length("\xf0\x9f\x8c"), 0);
}

static void test_json_out__everything_written_is_read_back(void **unused)
{
    (void)unused;
    struct json_out *out = json_out(arena);
    static const double numbers[] = {0, -1.5, 1e300, 0.1, 1.0 / 3, 5e-324, 123456789012345678.0};
    json_open(out, NULL, '{');
    json_open(out, "n", '[');
    for (size_t i = 0; i < 7; i++)
        json_put_number(out, NULL, numbers[i]);
    json_close(out);
    json_put_number(out, "nan", NAN);
    json_put_text(out, "text", "a \"b\" \\ \n\t\x01 \xc3\xa9");
    json_put_text(out, "latin", "caf\xe9!");
    json_put_text(out, "none", NULL);
    json_put_bool(out, "yes", true);
    json_put_u64(out, "hash", 0xfedcba9876543210u);
    json_open(out, "empty", '{');
    json_close(out);
    json_close(out);
    const char *text = json_out_text(out);
    assert_null(strchr(text, '\n'));
    struct error error = {0};
    struct json_doc *doc = json_parse(arena, text, "again", &error);
    assert_non_null(doc);
    struct json *root = json_root(doc);
    assert_int_equal(json_array(root, "n"), 7);
    for (size_t i = 0; i < 7; i++)
        assert_true(json_element_number(root, "n", i, -INFINITY, INFINITY) == numbers[i]);
    assert_true(isnan(numbers[0] * NAN));
    assert_true(json_number(root, "nan", 7, 0, 10) == 7);
    assert_string_equal(json_text(root, "text", ""), "a \"b\" \\ \n\t\x01 \xc3\xa9");
    assert_string_equal(json_text(root, "latin", ""), "caf\xef\xbf\xbd!");
    assert_null(json_text(root, "none", NULL));
    assert_true(json_bool(root, "yes", false));
    assert_true(json_u64(root, "hash") == 0xfedcba9876543210u);
    assert_non_null(json_object(root, "empty"));
    assert_int_equal(json_end(doc), STATUS_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_json__a_good_document_loads),
        cmocka_unit_test(test_json__errors_name_file_place_value_and_allowance),
        cmocka_unit_test(test_json__broken_text_names_the_line),
        cmocka_unit_test(test_json__deep_nesting_is_refused),
        cmocka_unit_test(test_json__utf8_is_what_rfc_3629_says),
        cmocka_unit_test(test_json_out__everything_written_is_read_back),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
