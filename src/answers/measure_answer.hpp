/// @file
/// A reference answer measured for a query, `dpdref answer --measure`; docs/answers.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign.hpp"

namespace dpd {

struct Code;

/// A file of answers that holds one state point alone: the fluid of the query, measured within a relative
/// error of viscosity and diffusion constant (load_answer), with what the cache lacks. Says beforehand what
/// that takes. `definitions` is the directory of answers.toml; `answers` has the state points by which the
/// price is known. InputError, Diverged (also of a fluid that came out ten times too hot), Interrupted.
std::string measure_answer(std::filesystem::path const& definitions, std::string const& answers,
                           std::vector<std::string> const& query, Code const* code, double within,
                           CampaignOptions const& options);

}  // namespace dpd
