#include "comparison_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "errors.hpp"
#include "names.hpp"

namespace dpd {

using Json = nlohmann::ordered_json;

Json to_json(Comparison const& c) {
    Json json{{"figure", c.figure},
              {"curve", c.curve},
              {"parameter", c.parameter},
              {"x", c.x},
              {"quantity", c.criterion.quantity},
              {"value", c.estimate.value},
              {"error", c.estimate.error},
              {"blocks", c.estimate.blocks},
              {"inefficiency", c.estimate.inefficiency},
              {"theory", c.criterion.theory},
              {"theory_value", c.theory},
              {"theory_error", c.theory_error},
              {"relation", name_of(c.criterion.relation)},
              {"tolerance", c.criterion.tolerance},
              {"resolution", c.criterion.resolution},
              {"runs", c.runs},
              {"seconds", c.seconds}};
    if (c.criterion.description) json["description"] = true;
    return json;
}

namespace {

// JSON has no NaN and writes null.
double number_or_nan(Json const& json) { return json.is_null() ? std::nan("") : json.get<double>(); }

}  // namespace

Comparison comparison_from_json(Json const& json) {
    Comparison c;
    c.figure = json.at("figure");
    c.curve = json.at("curve");
    c.parameter = json.at("parameter");
    c.x = json.at("x");
    c.criterion.quantity = json.at("quantity");
    c.estimate.value = json.at("value");
    c.estimate.error = number_or_nan(json.at("error"));
    c.estimate.blocks = json.at("blocks");
    c.estimate.inefficiency = json.at("inefficiency");
    c.criterion.theory = json.at("theory");
    c.theory = json.at("theory_value");
    c.theory_error = number_or_nan(json.at("theory_error"));
    auto const relation = json.at("relation").get<std::string>();
    auto const known = value_of<Relation>(relation);
    if (!known)
        throw InputError(
            fmt::format("relation '{}' is unknown; allowed: {}", relation, name_list<Relation>()));
    c.criterion.relation = *known;
    c.criterion.description = json.value("description", false);
    c.criterion.tolerance = json.at("tolerance");
    c.criterion.resolution = json.at("resolution");
    c.runs = json.at("runs");
    c.seconds = json.at("seconds");
    return c;
}

}  // namespace dpd
