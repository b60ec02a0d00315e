#include "campaign.hpp"

#include <exception>
#include <mutex>
#include <thread>

#include "progress.hpp"
#include "run.hpp"

namespace dpd {

void do_jobs(std::string const& title, std::vector<Job> const& jobs, CampaignOptions const& options) {
    double total = 0.0, done = 0.0;
    for (auto const& job : jobs) total += job.cost;
    Progress progress(title);
    std::mutex mutex;
    std::exception_ptr failure;
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> failed = false;
    auto const stopped = [&] { return options.stop && *options.stop; };
    auto const work = [&] {
        for (std::size_t index = next++; index < jobs.size(); index = next++) {
            if (failed || stopped()) return;
            Job const& job = jobs[index];
            double reported = 0.0;
            auto const report = [&](double fraction) {
                std::scoped_lock const lock(mutex);
                done += job.cost * (fraction - reported);
                reported = fraction;
                progress(done / total);
            };
            try {
                job.work(report);
                report(1.0);
            } catch (...) {
                std::scoped_lock const lock(mutex);
                if (!failure) failure = std::current_exception();
                failed = true;
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        for (unsigned t = 0; t < std::max(1u, options.jobs); ++t) threads.emplace_back(work);
    }
    if (failure) std::rethrow_exception(failure);
    if (stopped()) throw Interrupted("interrupted; finished runs are kept, run the command again to go on");
}

}  // namespace dpd
