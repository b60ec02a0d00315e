#include "signals.hpp"

#include <signal.h>
#include <unistd.h>

#include <initializer_list>
#include <string_view>

namespace dpd {
namespace {

std::atomic<bool> requested = false;
std::atomic<int> unhurried = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" void end_now(int) {
    constexpr std::string_view text =
        "dpdref: interrupted; what was in files before is kept, run again to go on\n";
    if (unhurried > 0) {
        ::alarm(1);
        return;
    }
    static_cast<void>(!::write(STDERR_FILENO, text.data(), text.size()));
    ::_exit(130);
}

extern "C" void request_stop(int signal) {
    if (requested.exchange(true)) return end_now(signal);
    ::alarm(1);
}

void on(int signal, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
}

}  // namespace

void catch_signals() {
    for (int const signal : {SIGINT, SIGTERM}) on(signal, request_stop);
    struct sigaction hangup {};
    ::sigaction(SIGHUP, nullptr, &hangup);
    if (hangup.sa_handler != SIG_IGN) on(SIGHUP, request_stop);
    on(SIGALRM, end_now);
    on(SIGXFSZ, SIG_IGN);
}

std::atomic<bool> const& stop_requested() { return requested; }

Unhurried::Unhurried() { ++unhurried; }
Unhurried::~Unhurried() { --unhurried; }

}  // namespace dpd
