#include "comparison_json.hpp"

#include <algorithm>
#include <cmath>

namespace dpd {

using Json = nlohmann::ordered_json;

Json to_json(Comparison const& c) {
    return {{"figure", c.figure},
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
}

namespace {

Relation relation_from_name(std::string_view name) {
    return static_cast<Relation>(std::find(relation_names.begin(), relation_names.end(), name) -
                                 relation_names.begin());
}

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
    c.criterion.relation = relation_from_name(json.at("relation").get<std::string>());
    c.criterion.tolerance = json.at("tolerance");
    c.criterion.resolution = json.at("resolution");
    c.runs = json.at("runs");
    c.seconds = json.at("seconds");
    return c;
}

}  // namespace dpd
