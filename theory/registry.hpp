/// @file
/// The closed forms by name, as `dpdref theory ID key=value ...` evaluates them.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "closed_forms.hpp"

namespace dpd::theory {

/// A parameter of the closed forms.
struct Parameter {
    std::string_view name;                         ///< on the command line
    std::string_view meaning;                      ///< with its unit
    std::optional<std::string_view> default_text;  ///< none: required; a form may have its own
    std::string_view allowed;                      ///< for messages, e.g. "> 0"
};

/// Every parameter a closed form can take.
std::span<Parameter const> parameters();

class Arguments;

/// One equation, its parameters and its code.
struct ClosedForm {
    std::string_view id;                       ///< on the command line
    std::string_view paper;                    ///< e.g. "NG2007"
    std::string_view equation;                 ///< its number there, or what it is derived from
    std::string_view quantity;                 ///< that it gives
    std::string_view formula;                  ///< plain text
    std::vector<std::string_view> parameters;  ///< what the value depends on
    std::vector<std::string_view>
        without_effect;                 ///< accepted and checked, but the value does not depend on it
    double (*value)(Arguments const&);  ///< its value; may throw std::domain_error where there is none
    /// Defaults of this form that differ from those of its parameters; an empty one makes it required.
    std::vector<std::pair<std::string_view, std::optional<std::string_view>>> defaults = {};
    /// For a form that is a sum: the value, the summands and what else belongs to it, by name; the value
    /// first.
    std::vector<std::pair<std::string_view, double>> (*parts)(Arguments const&) = nullptr;
    bool costly = false;  ///< seconds per value

    /// What `parameter` is when it is not given; nothing: it must be given.
    std::optional<std::string_view> default_text(Parameter const& parameter) const;
};

/// The values of one closed form's parameters, checked.
class Arguments {
public:
    /// From (name, text) pairs; what is not given takes its default.
    /// Throws std::invalid_argument, one line naming the parameter, the text and what is allowed, on a name
    /// that the form does not take or that comes twice, a missing one, and a text that is no allowed value.
    Arguments(ClosedForm const& form, std::span<std::pair<std::string, std::string> const> given);

    /// The number called `name`, which must be a parameter of the form.
    double operator[](std::string_view name) const;
    /// Dimension, 2 or 3.
    int d() const { return static_cast<int>((*this)["d"]); }
    /// Of the friction.
    Weight weight() const { return weight_; }
    /// That gives A.
    Scheme scheme() const { return scheme_; }
    /// w_R, or nothing when it is matched (w_R^2 = w_D).
    std::optional<Weight> random_weight() const { return random_weight_; }

private:
    void set(Parameter const& parameter, std::string_view text);

    std::map<std::string_view, double> numbers_;
    Weight weight_ = Weight::linear;
    Scheme scheme_ = Scheme::shardlow;
    std::optional<Weight> random_weight_;
};

/// Every closed form, in the order of the papers.
std::span<ClosedForm const> closed_forms();

/// The closed form of that id, or nullptr.
ClosedForm const* find(std::string_view id);

/// The form with memory (theory/memory.md) of what `id` says under molecular chaos; empty for ids that have
/// none.
std::string_view with_memory(std::string_view id);

/// The value of a closed form and, where it has them, its parts after it, as ClosedForm::parts. Throws as
/// evaluate.
std::vector<std::pair<std::string_view, double>> evaluate_parts(
    std::string_view id, std::span<std::pair<std::string, std::string> const> given);

/// The value of a closed form. Throws std::invalid_argument on an unknown id or as Arguments does, and
/// std::domain_error where the equation has no finite value.
double evaluate(std::string_view id, std::span<std::pair<std::string, std::string> const> given);

}  // namespace dpd::theory
