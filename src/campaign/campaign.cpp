#include "campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>

#include "errors.hpp"
#include "progress.hpp"

namespace dpd {

Shard shard_from_text(std::string_view text) {
    Shard shard;
    char const* const end = text.data() + text.size();
    auto const number = std::from_chars(text.data(), end, shard.number);
    bool const divided = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
    auto const count = divided ? std::from_chars(number.ptr + 1, end, shard.count) : number;
    if (!divided || count.ec != std::errc{} || count.ptr != end || shard.number < 1 ||
        shard.number > shard.count)
        throw InputError(
            fmt::format("--shard: {} is not allowed; allowed: k/n, integers with 1 <= k <= n", text));
    return shard;
}

std::vector<std::size_t> share_of(std::size_t jobs, Shard const& shard) {
    std::vector<std::size_t> share;
    for (std::size_t round = 0; round * shard.count < jobs; ++round) {
        std::size_t const place = round % 2 == 0 ? shard.number - 1 : shard.count - shard.number;
        if (std::size_t const job = round * shard.count + place; job < jobs) share.push_back(job);
    }
    return share;
}

std::vector<std::size_t> order_of(std::vector<double> const& costs, std::size_t workers) {
    double const total = std::accumulate(costs.begin(), costs.end(), 0.0);
    std::vector<std::size_t> order(costs.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    auto const rest = std::stable_partition(order.begin(), order.end(), [&](std::size_t job) {
        return 10.0 * costs[job] * double(std::max<std::size_t>(1, workers)) > total;
    });
    std::stable_sort(order.begin(), rest, [&](std::size_t a, std::size_t b) { return costs[a] > costs[b]; });
    return order;
}

bool do_jobs(std::string const& title, std::vector<Job> jobs, CampaignOptions const& options) {
    std::size_t const all = jobs.size();
    if (options.shard) {
        std::vector<Job> mine;
        for (std::size_t const job : share_of(all, *options.shard)) mine.push_back(std::move(jobs[job]));
        jobs = std::move(mine);
    }
    double total = 0.0, done = 0.0;
    for (auto const& job : jobs) total += job.cost;
    Progress progress(title);
    std::mutex mutex;
    std::exception_ptr failure;
    std::atomic<std::size_t> next = 0, cached = 0;
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
                if (job.work(report)) ++cached;
                report(1.0);
            } catch (Interrupted const&) {
                return;  // said below, unless another job failed
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
    if (stopped())
        throw Interrupted("interrupted; what was done is kept, the same command goes on from there");
    if (options.shard)
        fmt::print(
            "{}: shard {}/{}: {} of {} runs, {} of them were there; when all shards are done, copy their "
            "caches into one and run without --shard\n",
            title, options.shard->number, options.shard->count, jobs.size(), all, cached.load());
    return !options.shard;
}

}  // namespace dpd
