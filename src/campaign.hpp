/// @file
/// Many independent pieces of work on several threads, with one line of progress.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace dpd {

struct CampaignOptions {
    std::filesystem::path cache;   ///< of finished and unfinished runs
    std::filesystem::path output;  ///< of data and pictures
    unsigned jobs = 1;             ///< at a time
    std::atomic<bool> const* stop = nullptr;
};

/// One piece of work. `work` may report the fraction that is done.
struct Job {
    double cost = 1.0;  ///< share of the whole, any unit
    std::function<void(std::function<void(double)> const& report)> work;
};

/// Does the jobs in their order, `options.jobs` at a time. Throws the first error of a job, after which no
/// further one is begun; or Interrupted on `options.stop`.
void do_jobs(std::string const& title, std::vector<Job> const& jobs, CampaignOptions const& options);

}  // namespace dpd
