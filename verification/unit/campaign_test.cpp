/// @file
/// Campaigns: what a shard does, and that all shards of a campaign do all of it, each run once; what they say
/// meanwhile and when they are interrupted.
#define BOOST_TEST_MODULE campaign
#include "campaign.hpp"

#include <unistd.h>

#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "errors.hpp"
#include "progress.hpp"
#include "run.hpp"

using namespace dpd;

BOOST_AUTO_TEST_CASE(shards_share_all_jobs_and_none_twice) {
    for (std::size_t const jobs : {0u, 1u, 2u, 5u, 6u, 7u, 20u, 101u})
        for (std::size_t n = 1; n <= 7; ++n) {
            std::vector<std::size_t> all, wanted(jobs);
            for (std::size_t k = 1; k <= n; ++k) {
                auto const share = share_of(jobs, {k, n});
                BOOST_TEST(std::is_sorted(share.begin(), share.end()));
                BOOST_TEST(share.size() >= jobs / n);
                BOOST_TEST(share.size() <= jobs / n + 1);
                all.insert(all.end(), share.begin(), share.end());
            }
            std::sort(all.begin(), all.end());
            std::iota(wanted.begin(), wanted.end(), std::size_t(0));
            BOOST_TEST(all == wanted, boost::test_tools::per_element());
        }
}

// Dealt there and back, costs that fall along the list differ between shards by at most the largest cost;
// dealt one way only, costs that fall evenly would differ by (n-1)/n of the range.
BOOST_AUTO_TEST_CASE(shards_cost_about_the_same) {
    constexpr std::size_t jobs = 60;
    for (std::size_t const n : {2u, 3u, 5u}) {
        for (double const power : {1.0, 3.0}) {
            std::vector<double> cost(jobs), sum(n);
            for (std::size_t j = 0; j < jobs; ++j) cost[j] = std::pow(double(jobs - j), power);
            for (std::size_t k = 1; k <= n; ++k)
                for (auto const job : share_of(jobs, {k, n})) sum[k - 1] += cost[job];
            auto const [least, most] = std::minmax_element(sum.begin(), sum.end());
            BOOST_TEST(*most - *least <= (power == 1.0 ? 1e-9 : cost.front()));
        }
    }
}

// Costs of two figures' runs, one after the other: 100 in all, so that 5 is a tenth of the share of one of
// two.
BOOST_AUTO_TEST_CASE(long_jobs_come_first_and_the_others_as_they_belong_together) {
    std::vector<double> const costs{4, 20, 5, 3, 2, 30, 1, 6, 29};
    BOOST_TEST(order_of(costs, 2) == (std::vector<std::size_t>{5, 8, 1, 7, 0, 2, 3, 4, 6}),
               boost::test_tools::per_element());
    BOOST_TEST(order_of(costs, 1000) == (std::vector<std::size_t>{5, 8, 1, 7, 2, 0, 3, 4, 6}),
               boost::test_tools::per_element());
    BOOST_TEST(order_of({}, 2).empty());
}

BOOST_AUTO_TEST_CASE(a_shard_is_named_by_two_integers) {
    auto const shard = shard_from_text("3/8");
    BOOST_TEST(shard.number == 3u);
    BOOST_TEST(shard.count == 8u);
    BOOST_TEST(shard_from_text("1/1").count == 1u);
    for (auto const* text : {"", "/", "1", "1/", "/2", "0/2", "3/2", "-1/2", "1/-2", "1/2x", "x1/2", "1 / 2",
                             "1.0/2", "1/99999999999999999999999"}) {
        BOOST_TEST_CONTEXT(text) {
            BOOST_CHECK_EXCEPTION(shard_from_text(text), InputError, [&](InputError const& error) {
                return std::string(error.what()).find("allowed: k/n") != std::string::npos;
            });
        }
    }
}

BOOST_AUTO_TEST_CASE(a_shard_does_its_jobs_and_no_other) {
    std::vector<int> done(10, 0);
    std::vector<Job> jobs;
    for (int& one : done)
        jobs.push_back({1.0, [&one](auto const&) {
                            ++one;  // each job has its own
                            return false;
                        }});
    for (std::size_t k = 1; k <= 3; ++k) {
        CampaignOptions options;
        options.jobs = 2;
        options.shard = Shard{k, 3};
        BOOST_TEST(!do_jobs("test", jobs, options));
        for (auto const job : share_of(done.size(), *options.shard)) BOOST_TEST(done[job] == 1);
        BOOST_TEST(std::accumulate(done.begin(), done.end(), 0) == (k == 1 ? 3 : k == 2 ? 6 : 10));
    }
    BOOST_TEST(do_jobs("test", jobs, {}));
    for (int const times : done) BOOST_TEST(times == 2);
}

BOOST_AUTO_TEST_CASE(an_interrupted_campaign_says_how_to_go_on) {
    std::atomic<bool> stop = false;
    std::vector<Job> const jobs(3, {1.0, [&stop](auto const&) -> bool {
                                        stop = true;
                                        throw Interrupted("interrupted at step 3 of 5");
                                    }});
    CampaignOptions options;
    options.stop = &stop;
    BOOST_CHECK_EXCEPTION(do_jobs("test", jobs, options), Interrupted, [](Interrupted const& interrupted) {
        return std::string(interrupted.what()).find("the same command goes on") != std::string::npos;
    });
}

BOOST_AUTO_TEST_CASE(an_interruption_does_not_hide_a_run_that_failed) {
    std::atomic<bool> stop = false;
    std::vector<Job> const jobs{{1.0, [&stop](auto const&) -> bool {
                                     stop = true;
                                     throw Diverged("diverged at step 3");
                                 }}};
    CampaignOptions options;
    options.stop = &stop;
    BOOST_CHECK_THROW(do_jobs("test", jobs, options), Diverged);
}

BOOST_AUTO_TEST_CASE(progress_in_a_file_is_a_line_now_and_then) {
    auto const written = [](std::chrono::duration<double> interval) {
        std::FILE* const file = std::tmpfile();
        int const before = ::dup(STDERR_FILENO);
        ::dup2(::fileno(file), STDERR_FILENO);
        {
            Progress progress("figures", interval);
            for (double const fraction : {0.25, 0.5, 1.0}) progress(fraction);
        }
        std::fflush(stderr);
        ::dup2(before, STDERR_FILENO);
        ::close(before);
        std::rewind(file);
        std::string text(1000, ' ');
        text.resize(std::fread(text.data(), 1, text.size(), file));
        std::fclose(file);
        return text;
    };
    auto const lines = written(std::chrono::seconds(0));
    BOOST_TEST(std::count(lines.begin(), lines.end(), '\n') == 3);
    BOOST_TEST(lines.starts_with("figures: 25.0 % done after "), lines);
    BOOST_TEST(lines.find(" ? left\nfigures: 50.0 % done after ") != std::string::npos, lines);
    BOOST_TEST(lines.ends_with(" 0.0 s left\n"), lines);
    BOOST_TEST(lines.find('\r') == std::string::npos);
    BOOST_TEST(written(std::chrono::hours(1)).empty());
}
