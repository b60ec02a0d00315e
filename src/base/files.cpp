#include "files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <boost/crc.hpp>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <thread>
#include <utility>

#include "errors.hpp"
#include "progress.hpp"

namespace dpd {
namespace {

[[noreturn]] void fail(std::filesystem::path const& path, char const* problem, int error) {
    throw InputError(
        fmt::format("{}: cannot be {}: {}", path.string(), problem, std::generic_category().message(error)));
}

// A file descriptor that closes itself.
struct Descriptor {
    int number;
    explicit Descriptor(int n) : number(n) {}
    ~Descriptor() {
        if (number >= 0) ::close(number);
    }
    Descriptor(Descriptor const&) = delete;
    Descriptor& operator=(Descriptor const&) = delete;
};

int synchronize(std::filesystem::path const& path, int flags) {
    Descriptor const file(::open(path.c_str(), flags | O_CLOEXEC));
    // a file system without fsync (EINVAL) does what it can
    if (file.number < 0 || (::fsync(file.number) != 0 && errno != EINVAL)) return errno;
    return 0;
}

}  // namespace

std::string read_file(std::filesystem::path const& file) {
    constexpr std::size_t most_of_a_pipe = std::size_t{1} << 30;
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) fail(file, "read", errno);
    bool const pipe = S_ISFIFO(status.st_mode);
    if (S_ISDIR(status.st_mode)) fail(file, "read", EISDIR);
    if (!pipe && !S_ISREG(status.st_mode))
        throw InputError(fmt::format("{}: cannot be read: allowed: a file or a pipe", file.string()));
    Descriptor const input(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (input.number < 0) fail(file, "read", errno);
    std::string content;
    if (!pipe) content.reserve(static_cast<std::size_t>(status.st_size));
    std::string buffer(std::size_t{1} << 16, '\0');
    for (;;) {
        auto const count = ::read(input.number, buffer.data(), buffer.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(file, "read", errno);
        if (count == 0) return content;
        content.append(buffer, 0, static_cast<std::size_t>(count));
        if (pipe && content.size() > most_of_a_pipe)
            throw InputError(fmt::format("{}: cannot be read: a pipe of more than {} bytes", file.string(),
                                         most_of_a_pipe));
    }
}

void write_file(std::filesystem::path const& path, std::string_view content) {
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))
        throw InputError(fmt::format("{}: cannot be written: is no regular file", path.string()));
    auto temporary = path;
    temporary += ".part";
    int error = 0;
    {
        Descriptor const output(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
        if (output.number < 0) fail(path, "written", errno);
        while (!content.empty() && error == 0) {
            auto const count = ::write(output.number, content.data(), content.size());
            if (count >= 0)
                content.remove_prefix(static_cast<std::size_t>(count));
            else if (errno != EINTR)
                error = errno;
        }
    }
    if (error != 0) {
        ::unlink(temporary.c_str());
        fail(path, "written", error);
    }
    put_in_place(temporary, path);
}

void put_in_place(std::filesystem::path const& temporary, std::filesystem::path const& path) {
    int error = synchronize(temporary, O_RDONLY);
    if (error == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        fail(path, "written", error);
    }
    // so that a power failure leaves the old file or the new one
    synchronize(path.has_parent_path() ? path.parent_path() : ".", O_RDONLY | O_DIRECTORY);
}

std::filesystem::path move_aside(std::filesystem::path const& path) {
    auto const aside = std::filesystem::path(path).concat(".damaged");
    if (::rename(path.c_str(), aside.c_str()) != 0) fail(path, "moved aside", errno);
    return aside;
}

std::optional<std::filesystem::path> find_above(std::filesystem::path const& path, std::string const& name) {
    auto directory = std::filesystem::absolute(path).lexically_normal();
    do {
        directory = directory.parent_path();
        if (std::filesystem::exists(directory / name)) return directory / name;
    } while (directory != directory.parent_path());
    return {};
}

std::uint64_t digest(std::string_view bytes) {
    boost::crc_optimal<64, 0x42F0E1EBA9EA3693, ~std::uint64_t{0}, ~std::uint64_t{0}, true, true> crc;
    crc.process_bytes(bytes.data(), bytes.size());
    return crc.checksum();
}

FileLock::FileLock(std::filesystem::path const& path, std::function<bool()> const& stopped)
    : path_(std::filesystem::path(path).concat(".lock")) {
    static std::atomic<bool> said = false;
    for (;;) {
        descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor_ < 0) return;  // what cannot be written is said when the file itself is
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) {
            // not one that its last owner has removed meanwhile
            struct stat mine {
            }, there{};
            if (::fstat(descriptor_, &mine) == 0 && ::stat(path_.c_str(), &there) == 0 &&
                mine.st_ino == there.st_ino && mine.st_dev == there.st_dev)
                return;
            ::close(std::exchange(descriptor_, -1));
            continue;
        }
        int const error = errno;
        ::close(std::exchange(descriptor_, -1));
        if (error != EWOULDBLOCK && error != EINTR) return;
        if (!said.exchange(true))
            warn(fmt::format("{}: another process works on it; waiting", path.string()));
        if (stopped && stopped()) throw Interrupted("interrupted while another process worked on the run");
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
}

FileLock::~FileLock() {
    if (descriptor_ < 0) return;
    ::unlink(path_.c_str());
    ::close(descriptor_);
}

}  // namespace dpd
