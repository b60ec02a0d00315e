// The exact answers for other codes: what is committed is what the engine gives, conserves what it must, and
// shows what the cases are for. That the numbers are right, verification/answers/check_exact.py finds without
// the engine.
#define BOOST_TEST_MODULE exact
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "errors.hpp"
#include "exact_answers.hpp"
#include "files.hpp"
#include "toml_reader.hpp"
#include "version.hpp"

using namespace dpd;
using Json = nlohmann::ordered_json;

namespace {

std::filesystem::path const definition = DPDREF_VERIFICATION "/answers/exact.toml";
std::filesystem::path const committed = DPDREF_VERIFICATION "/../figures/answers/exact.json";

Json const& answers() {
    static Json const once = exact_answers(definition);
    return once;
}

Json const& find(std::string_view id) {
    auto const& cases = answers()["cases"];
    auto const found =
        std::find_if(cases.begin(), cases.end(), [&](Json const& one) { return one["id"] == id; });
    BOOST_REQUIRE_MESSAGE(found != cases.end(), id);
    return *found;
}

// The largest difference of two numbers in the same place, relative to the larger or to 1.
double difference(Json const& a, Json const& b) {
    if (a.is_number() && b.is_number()) {
        double const x = a, y = b;
        return std::abs(x - y) / std::max({1.0, std::abs(x), std::abs(y)});
    }
    if (!a.is_structured()) return a == b ? 0.0 : INFINITY;
    if (a.size() != b.size()) return INFINITY;
    double worst = 0.0;
    auto other = b.begin();
    for (auto const& one : a) worst = std::max(worst, difference(one, *other++));
    return worst;
}

// Sum of m v along an axis, where particles that have left a sheared box are counted with the speed that they
// left it with.
double momentum(Json const& one, Json const& state, std::size_t axis) {
    auto const& box = one["box"];
    double const image_speed = box["shear_rate"].get<double>() * box["length"][1].get<double>();
    double sum = 0.0;
    for (std::size_t p = 0; p < state["velocity"].size(); ++p) {
        sum += state["velocity"][p][axis].get<double>();
        if (axis == 0) sum += image_speed * state["image"][p][1].get<double>();
    }
    return one["mass"].get<double>() * sum;
}

}  // namespace

// Other processors round the same in the portable builds; a native one contracts, and rounds less.
BOOST_AUTO_TEST_CASE(the_committed_file_is_what_the_engine_gives) {
    std::string const text = read_file(committed);
    if (std::string(build_flags).find("native") == std::string::npos)
        BOOST_TEST((text == exact_answers_text(answers())));
    BOOST_TEST(difference(Json::parse(text), answers()) < 1e-13);
}

BOOST_AUTO_TEST_CASE(text_keeps_every_bit) {
    BOOST_TEST((Json::parse(exact_answers_text(answers())) == answers()));
}

BOOST_AUTO_TEST_CASE(the_search_does_not_show) {
    BOOST_TEST((exact_answers(definition, Search::brute) == answers()));
}

BOOST_AUTO_TEST_CASE(momentum_is_conserved_to_rounding) {
    for (auto const& one : answers()["cases"]) {
        if (one["id"] == "body-force") continue;
        for (auto const& step : one["steps"])
            for (std::size_t axis = 0; axis < one["dimension"]; ++axis) {
                double const before = momentum(one, one["initial"], axis), after = momentum(one, step, axis);
                BOOST_TEST(std::abs(after - before) < 1e-14 * one["mass"].get<double>(), one["id"]);
            }
    }
}

// The force on either half of the box: 0.7 on the two particles below the middle, -0.7 on those above.
BOOST_AUTO_TEST_CASE(body_force_by_hand) {
    auto const& one = find("body-force");
    for (std::size_t p : {0u, 1u, 2u, 3u}) {
        double const sign = one["initial"]["position"][p][1] < 2.0 ? 1.0 : -1.0;
        double const change =
            one["steps"][0]["velocity"][p][0].get<double>() - one["initial"]["velocity"][p][0].get<double>();
        BOOST_TEST(std::abs(change - sign * 0.07) < 1e-15);
    }
}

namespace {

// Who comes when in the noise of a step.
std::vector<std::pair<int, int>> pairs_of(Json const& step) {
    std::vector<std::pair<int, int>> pairs;
    for (auto const& draw : step["noise"])
        if (draw.contains("pair")) pairs.emplace_back(draw["pair"][0], draw["pair"][1]);
    return pairs;
}

}  // namespace

// Most codes have (1-x)^2, and most cases that have a weight have it, too.
BOOST_AUTO_TEST_CASE(most_cases_have_the_weight_that_codes_have) {
    int quadratic = 0, others = 0;
    for (auto const& one : answers()["cases"])
        for (char const* const stage : {"shardlow", "euler", "modified_verlet"})
            if (one.contains(stage)) ++(one[stage]["weight"] == "quadratic" ? quadratic : others);
    BOOST_TEST(quadratic > 3 * others, quadratic << " of " << quadratic + others);
}

// A positive normal drives its pair apart.
BOOST_AUTO_TEST_CASE(the_sign_of_the_noise_is_said) {
    BOOST_TEST(answers()["sign"] == "a positive normal drives its pair apart");
    auto const& two = find("shardlow-two");
    auto const& draw = two["steps"][0]["noise"][0];
    double along = 0.0, approach = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        auto const value = [&](Json const& state, char const* what, std::size_t p) {
            return state[what][p][axis].get<double>();
        };
        auto const& before = two["initial"];
        double const e =
            (value(before, "position", 0) - value(before, "position", 1)) / draw["distance"].get<double>();
        along += e * (value(two["steps"][0], "velocity", 0) - value(before, "velocity", 0));
        approach += e * (value(before, "velocity", 0) - value(before, "velocity", 1));
    }
    double const x = draw["distance"], a = 4.5 * (1 - x) * (1 - x) * 0.1, A = a / (1 + a);
    double const noise = std::sqrt(2 * A * (1 - A)) * draw["normal"].get<double>();
    BOOST_TEST(std::abs(along - (-A * approach + noise)) < 1e-14);
    BOOST_TEST(std::abs(noise) > 0.01);
}

// Another order of the same pairs with the same noise: what is listed is that order, every state is another
// one where four particles are updated in sequence, and where the order does not matter nothing changes.
BOOST_AUTO_TEST_CASE(the_order_of_the_pairs_can_be_given) {
    auto const order = pair_order_from_text("3-2,1-2,0-1 0-3\n0-2,1-3", "order");
    Json const other = exact_answers(definition, Search::cell, order);
    BOOST_TEST((other == exact_answers(definition, Search::brute, order)));
    BOOST_TEST((other["order"] == Json::parse("[[2,3],[1,2],[0,1],[0,3],[0,2],[1,3]]")));
    for (std::size_t k = 0; k < answers()["cases"].size(); ++k) {
        auto const &by_id = answers()["cases"][k], &one = other["cases"][k];
        BOOST_TEST_CONTEXT(by_id["id"]) {
            bool const sequential = by_id.contains("shardlow") || by_id.contains("lowe");
            bool const four = by_id["initial"]["position"].size() == 4;
            BOOST_TEST((by_id["steps"] != one["steps"]) == (sequential && four));
            if (!(sequential && four)) continue;
            // the first step begins in the same state: the same pairs, each with its own noise
            auto const &before = by_id["steps"][0], &after = one["steps"][0];
            BOOST_TEST((before["velocity"] != after["velocity"]));
            auto const ids = pairs_of(before), given = pairs_of(after);
            std::vector<std::pair<int, int>> expected;  // of each sweep
            for (std::pair<int, int> const pair : order)
                if (std::ranges::find(ids, pair) != ids.end()) expected.push_back(pair);
            BOOST_TEST_REQUIRE(given.size() == ids.size());
            for (std::size_t p = 0; p < given.size(); ++p)
                BOOST_TEST((given[p] == expected[p % expected.size()]));
            for (auto const& draw : after["noise"])
                BOOST_TEST((std::ranges::find(before["noise"], draw) != before["noise"].end()));
            for (std::size_t axis = 0; axis < one["dimension"]; ++axis)
                BOOST_TEST(std::abs(momentum(one, after, axis) - momentum(one, one["initial"], axis)) <
                           1e-14 * one["mass"].get<double>());
        }
    }
    // the order of ids is the one that is there without
    auto by_id =
        exact_answers(definition, Search::cell, pair_order_from_text("0-1,0-2,0-3,1-2,1-3,2-3", "order"));
    by_id.erase("order");
    BOOST_TEST((by_id == answers()));
}

BOOST_AUTO_TEST_CASE(bad_orders_are_refused) {
    auto const refused = [](std::string const& text, std::string const& why) {
        BOOST_CHECK_EXCEPTION(exact_answers(definition, Search::cell, pair_order_from_text(text, "order")),
                              InputError, [&](InputError const& error) {
                                  std::string const line = error.what();
                                  BOOST_TEST_MESSAGE(line);
                                  return line.find(why) != std::string::npos &&
                                         line.find('\n') == std::string::npos;
                              });
    };
    refused("", "no pair");
    refused(" , ", "no pair");
    refused("/no/such/file", "'/no/such/file' is no pair");
    refused("0-1,2", "'2' is no pair");
    refused("0-1,1-", "'1-' is no pair");
    refused("0-1,-1-2", "'-1-2' is no pair");
    refused("0-1,1-2x", "'1-2x' is no pair");
    refused("0-1,99999999999-2", "is no pair");
    refused("0-1,2-2", "'2-2' is no pair");
    refused("0-1,1-2,1-0", "'1-0' comes twice");
    refused("0-1,0-2,0-3,1-2,1-3", "2-3 is missing; allowed: each pair of the particles 0 to 3 once");
    refused("0-1,0-2,0-3,1-2,1-3,2-3,3-4", "3-4 is no pair of the largest case");
}

// OpenMM's own words (ReferenceDPDDynamics.cpp, updatePart1 and updatePart2): friction is a rate, the line
// goes from the first particle to the second, and so does the noise: its number is minus the one that is
// listed.
BOOST_AUTO_TEST_CASE(openmm_in_its_own_words) {
    for (char const* const id : {"openmm", "openmm-friction-only", "openmm-two", "openmm-heavy"}) {
        auto const& one = find(id);
        double const m = one["mass"], dt = one["time_step"], kT = one["shardlow"]["kT"];
        double const friction = one["shardlow"]["friction"].get<double>() / m,
                     cutoff = one["shardlow"]["cutoff"];
        double const strength = one["half_kick"]["soft"]["strength"];
        using Rows = std::vector<std::array<double, 3>>;
        Rows r = one["initial"]["position"], v = one["initial"]["velocity"];
        auto const line = [&](std::size_t i, std::size_t j) {
            std::array<double, 3> to{};
            double square = 0.0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                to[axis] = r[j][axis] - r[i][axis];
                square += to[axis] * to[axis];
            }
            for (double& x : to) x /= std::sqrt(square);
            return std::pair(to, std::sqrt(square));
        };
        auto const drift = [&](double span) {
            for (std::size_t i = 0; i < r.size(); ++i)
                for (std::size_t axis = 0; axis < 3; ++axis) r[i][axis] += span * v[i][axis];
        };
        for (auto const& step : one["steps"]) {
            for (std::size_t i = 0; i < r.size(); ++i)
                for (std::size_t j = 0; j < r.size(); ++j) {
                    if (i == j) continue;
                    auto const [to, distance] = line(i, j);
                    if (distance < 1.0)
                        for (std::size_t axis = 0; axis < 3; ++axis)
                            v[i][axis] -= dt / m * strength * (1 - distance) * to[axis];
                }
            drift(dt / 2);
            for (auto const& draw : step["noise"]) {
                std::size_t const i = draw["pair"][0], j = draw["pair"][1];
                auto const [dir, distance] = line(i, j);
                double const mu = m / 2, omega = 1 - distance / cutoff;
                double const vscale = std::exp(-dt * 2 * friction * omega * omega);
                double along = 0.0;
                for (std::size_t axis = 0; axis < 3; ++axis) along += (v[j][axis] - v[i][axis]) * dir[axis];
                double const number = draw.contains("normal") ? -draw["normal"].get<double>() : 0.0;
                double const dv =
                    (1 - vscale) * along + std::sqrt(1 - vscale * vscale) * std::sqrt(kT / mu) * number;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    v[i][axis] += mu / m * dv * dir[axis];
                    v[j][axis] -= mu / m * dv * dir[axis];
                }
            }
            drift(dt / 2);
            BOOST_TEST(difference(Json(r), step["position"]) < 1e-14, id);
            BOOST_TEST(difference(Json(v), step["velocity"]) < 1e-14, id);
        }
    }
}

BOOST_AUTO_TEST_CASE(cases_show_what_they_are_for) {
    BOOST_TEST(answers()["cases"].size() >= 40u);
    for (auto const& one : answers()["cases"]) {
        std::string const id = one["id"];
        for (auto const& step : one["steps"])
            for (auto const& draw : step["noise"])
                if (draw.contains("pair"))
                    BOOST_TEST(draw.contains("normal") == !id.ends_with("friction-only"), id);
        // every case moves, and a second step adds to the first
        BOOST_TEST((one["steps"][0]["position"] != one["initial"]["position"]), id);
        BOOST_TEST((one["steps"][1]["position"] != one["steps"][0]["position"]), id);
    }
    // the order of the pairs
    auto const& noise = find("shardlow")["steps"][0]["noise"];
    for (std::size_t k = 0; auto const& pair : {Json{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}})
        BOOST_TEST((noise[k++]["pair"] == pair));
    // Lowe: a hit, then none
    auto const& lowe = find("lowe-two");
    double const probability = lowe["lowe"]["rate"].get<double>() * lowe["time_step"].get<double>();
    BOOST_TEST(lowe["steps"][0]["noise"][0]["uniform"] < probability);
    BOOST_TEST(lowe["steps"][1]["noise"][0]["uniform"] > probability);
    BOOST_TEST((lowe["steps"][0]["velocity"] != lowe["initial"]["velocity"]));
    BOOST_TEST((lowe["steps"][1]["velocity"] == lowe["steps"][0]["velocity"]));
    // in and out of the cutoff
    auto const& edge = find("shardlow-edge")["steps"];
    BOOST_TEST((edge[0]["noise"].size() == 1u && edge[0]["noise"][0]["pair"] == Json{0, 1}));
    BOOST_TEST((edge[1]["noise"].size() == 1u && edge[1]["noise"][0]["pair"] == Json{0, 2}));
    BOOST_TEST(edge[0]["noise"][0]["distance"] == 0.999, boost::test_tools::tolerance(1e-14));
    // through the boundaries, at rest and sheared
    BOOST_TEST((find("shardlow-across")["steps"][0]["image"][0] == Json{0, 1, 0}));
    BOOST_TEST((find("shardlow-sheared")["steps"][0]["image"][0] == Json{-1, 1, 0}));
    // a Monte Carlo factor that is accepted
    auto const& monte_carlo = find("rescale-monte-carlo");
    BOOST_TEST((monte_carlo["steps"][0]["velocity"] != monte_carlo["initial"]["velocity"]));
}

BOOST_AUTO_TEST_CASE(bad_definitions_are_refused) {
    auto const file = std::filesystem::temp_directory_path() /
                      ("dpdref_exact_test." + std::to_string(::getpid()) + ".toml");
    auto const refused = [&](std::string const& text, std::string const& why) {
        std::ofstream(file) << text;
        BOOST_CHECK_EXCEPTION(exact_answers(file), InputError, [&](InputError const& error) {
            BOOST_TEST_MESSAGE(error.what());
            return std::string(error.what()).find(why) != std::string::npos;
        });
    };
    std::string const scene =
        "[scene]\ndimension = 3\nstages = ['drift']\nbox = {length = [4.0, 4.0, 4.0]}\n"
        "particles = {mass = 1.0}\ntime = {step = 0.1, duration = 1.0}\n";
    std::string const inside = "[state.p]\nposition = [1, 1, 1, 2, 2, 2]\nvelocity = [1, 1, 1, 2, 2, 2]\n",
                      outside = "[state.p]\nposition = [1, 1, 1, 2, 2, 4]\nvelocity = [1, 1, 1, 2, 2, 2]\n",
                      odd = "[state.p]\nposition = [1, 2]\nvelocity = [1, 2]\n";
    std::string const one = "[[case]]\nid = 'a'\n", full = one + "source = 's'\nstate = 'p'\n";
    refused(scene + inside + one, "case a: source: is missing");
    refused(scene + full, "[state.p]");
    refused(scene + odd + full, "three numbers per particle");
    refused(scene + outside + full, "outside of the box");
    refused(scene + inside + full + "nonsense = 1\n", "nonsense: unknown key");
    refused(scene + inside + full +
                "stages = ['modified_verlet']\nwalls = {thickness = 1.0}\n"
                "modified_verlet = {gamma = 1.0, sigma = 1.0, soft = {strength = 1.0}}\n",
            "no walls");
    refused("[oops]\n", "oops: unknown key");
    std::filesystem::remove(file);
}
