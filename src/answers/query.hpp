/// @file
/// What `dpdref answer` is asked: key=value of the closed forms' parameters, or of those of a code.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "conventions.hpp"
#include "state_point.hpp"

namespace dpd {

/// A query in reduced units, and its own.
struct Query {
    Units units;        ///< of the query
    int d = 3;          ///< dimensions
    Assignments asked;  ///< parameters by the names of docs/answers.md, in units of cutoff, mass and kT
};

/// The text of a file of answers. InputError.
nlohmann::ordered_json parse_answers(std::string const& text);

/// Whether the words are the id of a state point.
bool is_id(std::vector<std::string> const& words, Code const* code);

/// The state point of that id. InputError lists all.
nlohmann::ordered_json const& state_named(nlohmann::ordered_json const& states, std::string const& id);

/// A query in the closed forms' parameters, or in those of a code, whose integrator is meant if no other is
/// named. What a key may be the state points say. InputError.
Query read_query(nlohmann::ordered_json const& states, std::vector<std::string> const& words,
                 Code const* code);

/// The value of a key; `fallback` if it is not there.
std::string value_in(Assignments const& assignments, std::string_view key, std::string const& fallback);

/// The value of a key as a number >= 0. InputError.
double asked_number(std::string const& key, std::string const& text);

/// Whether the values of that key are no numbers.
bool is_text(std::string_view key);

/// A parameter of a state point as a query would have it.
std::string text_of(nlohmann::ordered_json const& value);

/// For which share of a step an integrator of the state points predicts velocities; 1/2 if it does not.
double lambda_of(std::string_view integrator);

/// Of the state points' integrators the one that moves particles as a code does; empty where none predicts
/// for `lambda`.
std::string_view integrator_of(Mover mover, double lambda = DpdFluid{}.lambda);

}  // namespace dpd
