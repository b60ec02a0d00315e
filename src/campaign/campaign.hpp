/// @file
/// Many independent pieces of work on several threads, with one line of progress.
#pragma once

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dpd {

/// One of `count` parts of a campaign that different machines do.
struct Shard {
    std::size_t number = 1;  ///< from 1
    std::size_t count = 1;   ///< number of shards
};

/// "k/n", 1 <= k <= n. InputError for anything else.
Shard shard_from_text(std::string_view text);

/// Which of `jobs` jobs, in order of their cost, are the shard's: dealt there and back, 1 2 3 3 2 1 1 2 ...,
/// so that the shards cost about the same. The shards of one count share all jobs among them, each in one
/// shard.
std::vector<std::size_t> share_of(std::size_t jobs, Shard const& shard);

/// How a campaign is run, and where.
struct CampaignOptions {
    std::filesystem::path cache;              ///< of finished and unfinished runs
    std::filesystem::path output;             ///< of data and pictures
    unsigned jobs = 1;                        ///< at a time
    std::atomic<bool> const* stop = nullptr;  ///< ends the campaign after the present step of its runs
    std::optional<Shard> shard = {};          ///< do only this part, into the cache
};

/// Told now and then which fraction of a piece of work is done.
using Report = std::function<void(double fraction)>;

/// One piece of work. It returns whether the cache held the result.
struct Job {
    double cost = 1.0;                               ///< share of the whole, any unit
    std::function<bool(Report const& report)> work;  ///< false if it was stopped
};

/// Does the jobs in their order, `options.jobs` at a time; a shard's share is even if that is of their cost.
/// Throws the first error of a job, after which no further one is begun; without one, Interrupted on
/// `options.stop`.
/// With a shard it does its share only, says so in one line, and returns false: there is nothing to draw yet.
bool do_jobs(std::string const& title, std::vector<Job> jobs, CampaignOptions const& options);

/// A piece of work with a result that several parts of a campaign may ask for, by the same key.
template <class Result>
struct Task {
    std::string key;    ///< of its result in the cache
    double cost = 1.0;  ///< share of the whole, any unit
    /// Fills in the result; returns whether the cache held it.
    std::function<bool(Result& result, Report const& report)> work;
};

/// The order in which jobs of these costs are begun by so many workers. First what is longer than a tenth of
/// a worker's share, the longest first, so that no worker is left with a long one at the end; then the others
/// as they come, so that what belongs together is finished together.
std::vector<std::size_t> order_of(std::vector<double> const& costs, std::size_t workers);

/// The results of all tasks by their keys, those that share a key done once, as do_jobs does them in the
/// order of order_of; with a shard the longest first, and nothing is returned.
template <class Result>
std::optional<std::map<std::string, Result>> do_once(std::string const& title,
                                                     std::vector<Task<Result>> const& tasks,
                                                     CampaignOptions const& options) {
    std::filesystem::create_directories(options.cache);
    std::map<std::string, Result> results;
    std::vector<Job> jobs;
    for (auto const& task : tasks)
        if (auto const [place, added] = results.try_emplace(task.key); added)
            jobs.push_back({task.cost, [&task, &result = place->second](Report const& report) {
                                return task.work(result, report);
                            }});
    std::vector<double> costs;
    for (auto const& job : jobs) costs.push_back(job.cost);
    std::vector<Job> ordered;
    for (std::size_t const job :
         order_of(costs, options.shard ? std::numeric_limits<std::size_t>::max() : options.jobs))
        ordered.push_back(std::move(jobs[job]));
    if (!do_jobs(title, std::move(ordered), options)) return {};
    return results;
}

}  // namespace dpd
