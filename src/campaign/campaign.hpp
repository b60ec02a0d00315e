/// @file
/// Many independent pieces of work on several threads, with one line of progress.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dpd {

/// One of `count` parts of a campaign that different machines do.
struct Shard {
    std::size_t number = 1;  ///< from 1
    std::size_t count = 1;
};

/// "k/n", 1 <= k <= n. InputError for anything else.
Shard shard_from_text(std::string_view text);

/// Which of `jobs` jobs, in order of their cost, are the shard's: dealt there and back, 1 2 3 3 2 1 1 2 ...,
/// so that the shards cost about the same. The shards of one count share all jobs among them, each in one
/// shard.
std::vector<std::size_t> share_of(std::size_t jobs, Shard const& shard);

struct CampaignOptions {
    std::filesystem::path cache;   ///< of finished and unfinished runs
    std::filesystem::path output;  ///< of data and pictures
    unsigned jobs = 1;             ///< at a time
    std::atomic<bool> const* stop = nullptr;
    std::optional<Shard> shard = {};  ///< do only this part, into the cache
};

/// One piece of work. `work` may report the fraction that is done; it returns whether the cache held the
/// result.
struct Job {
    double cost = 1.0;  ///< share of the whole, any unit
    std::function<bool(std::function<void(double)> const& report)> work;
};

/// Does the jobs in their order, which is that of their cost, `options.jobs` at a time. Throws the first
/// error of a job, after which no further one is begun; or Interrupted on `options.stop`. With a shard it
/// does its share only, says so in one line, and returns false: there is nothing to draw yet.
bool do_jobs(std::string const& title, std::vector<Job> jobs, CampaignOptions const& options);

}  // namespace dpd
