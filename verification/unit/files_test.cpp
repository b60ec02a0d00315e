// Files: whole or not at all, digests, trajectories that survive, locks, texts for gnuplot.
#define BOOST_TEST_MODULE files
#include "files.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <boost/test/unit_test.hpp>
#include <csignal>
#include <fstream>
#include <thread>

#include "archive.hpp"
#include "errors.hpp"
#include "picture.hpp"
#include "trajectory.hpp"

using namespace dpd;

namespace {

namespace fs = std::filesystem;

struct Directory {
    fs::path path = fs::temp_directory_path() / fmt::format("dpdref-files-{}", ::getpid());
    Directory() { fs::create_directories(path); }
    ~Directory() { fs::remove_all(path); }
};

// While it lives, files grow to `bytes` only.
struct SmallFiles {
    rlimit before{};
    explicit SmallFiles(rlim_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &before);
        rlimit const limit{bytes, before.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~SmallFiles() { ::setrlimit(RLIMIT_FSIZE, &before); }
};

void put(fs::path const& path, std::string const& content) {
    std::ofstream(path, std::ios::binary) << content;
}

bool parts_are_left(fs::path const& directory) {
    for (auto const& entry : fs::directory_iterator(directory))
        if (entry.path().extension() == ".part") return true;
    return false;
}

TrajectoryOf const two_particles{.run = "mine", .box_length = {4.0, 4.0}, .particles = 2, .shear_rate = 0.1};

void append(Trajectory& trajectory, std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t step = from; step <= to; ++step) {
        double const x = 0.1 * double(step);
        trajectory.append(step, x, {x, 1.0, 2.0, x}, {1.0, -x, x, 2.0}, {0, 1, -1, int(step)});
    }
}

}  // namespace

BOOST_AUTO_TEST_CASE(digest_is_crc64_of_the_catalogue) {
    // CRC-64/XZ of the catalogue of CRC algorithms: its check value
    BOOST_TEST(digest("123456789") == 0x995dc9bbdf1939faULL);
}

BOOST_AUTO_TEST_CASE(a_file_is_written_whole_or_not_at_all) {
    Directory const directory;
    auto const file = directory.path / "a.txt";
    write_file(file, "good");
    {
        SmallFiles const limit(1000);
        BOOST_CHECK_THROW(write_file(file, std::string(5000, 'x')), InputError);
    }
    BOOST_TEST(read_file(file) == "good");
    BOOST_TEST(!parts_are_left(directory.path));
    write_file(file, std::string(5000, 'x'));
    BOOST_TEST(read_file(file).size() == 5000u);
}

BOOST_AUTO_TEST_CASE(what_is_no_file_is_refused) {
    Directory const directory;
    BOOST_CHECK_THROW(read_file("/dev/zero"), InputError);
    BOOST_CHECK_THROW(read_file(directory.path), InputError);
    BOOST_CHECK_THROW(read_file(directory.path / "missing"), InputError);
    BOOST_CHECK_THROW(write_file("/dev/null", "x"), InputError);
    auto const pipe = directory.path / "pipe";
    BOOST_REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    BOOST_CHECK_THROW(write_file(pipe, "x"), InputError);
    BOOST_CHECK_THROW(Archive(pipe, Archive::Mode::read), InputError);
    std::jthread const writer([&] { put(pipe, "from a pipe"); });
    BOOST_TEST(read_file(pipe) == "from a pipe");
}

BOOST_AUTO_TEST_CASE(every_flipped_bit_of_an_archive_is_noticed) {
    Directory const directory;
    auto const file = directory.path / "a.h5";
    std::vector<double> const values{1.0, 2.5, -3.0};
    {
        Archive archive(file, Archive::Mode::write);
        auto copy = values;
        archive("group/values", copy);
        archive.commit();
    }
    std::string const good = read_file(file);
    BOOST_TEST(Archive::is_ours(file));
    int noticed = 0;
    for (std::size_t byte = 0; byte < good.size(); ++byte) {
        auto bad = good;
        bad[byte] = char(bad[byte] ^ (1 << byte % 8));
        put(file, bad);
        try {
            Archive const archive(file, Archive::Mode::read);
        } catch (Damaged const&) {
            ++noticed;
        }
    }
    BOOST_TEST(noticed == int(good.size()));
    put(file, good);
    Archive archive(file, Archive::Mode::read);
    std::vector<double> read;
    archive("group/values", read);
    BOOST_TEST(read == values, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(a_trajectory_has_the_same_bytes_however_often_it_was_interrupted) {
    Directory const directory;
    auto const once = directory.path / "once.h5md", often = directory.path / "often.h5md";
    {
        Trajectory trajectory(once, two_particles, 0, 0);
        append(trajectory, 1, 50);
        trajectory.commit();
    }
    {
        Trajectory trajectory(often, two_particles, 0, 0);
        append(trajectory, 1, 7);
        trajectory.commit();
        append(trajectory, 8, 9);  // lost: not committed
    }
    BOOST_TEST(!parts_are_left(directory.path));
    {
        Trajectory trajectory(often, two_particles, 7, 7);
        append(trajectory, 8, 20);
        trajectory.commit();
        append(trajectory, 21, 30);
        trajectory.commit();
    }
    {
        Trajectory trajectory(often, two_particles, 12,
                              12);  // a checkpoint older than the last frames: they are cut
        append(trajectory, 13, 50);
        trajectory.commit();
    }
    BOOST_TEST(read_file(once) == read_file(often));
}

BOOST_AUTO_TEST_CASE(a_trajectory_that_is_gone_or_of_another_run_is_refused) {
    Directory const directory;
    auto const path = directory.path / "a.h5md";
    BOOST_CHECK_THROW(Trajectory(path, two_particles, 3, 3), InputError);
    put(path, "precious");
    BOOST_CHECK_THROW(Trajectory(path, two_particles, 0, 0), InputError);
    BOOST_TEST(read_file(path) == "precious");
    fs::remove(path);
    auto other = two_particles;
    other.run = "other";
    { Trajectory const begun(path, other, 0, 0); }
    BOOST_CHECK_THROW(Trajectory(path, two_particles, 0, 0), InputError);
    BOOST_CHECK_NO_THROW(Trajectory(path, other, 0, 0));
    BOOST_CHECK_THROW(Trajectory(path, other, 1, 1), InputError);  // lacks a frame
}

BOOST_AUTO_TEST_CASE(a_full_disk_leaves_the_committed_frames) {
    Directory const directory;
    auto const path = directory.path / "a.h5md";
    Trajectory trajectory(path, two_particles, 0, 0);
    append(trajectory, 1, 5);
    trajectory.commit();
    std::string const good = read_file(path);
    {
        SmallFiles const limit(good.size() + 2000);
        BOOST_CHECK_THROW(append(trajectory, 6, 500), InputError);
    }
    BOOST_TEST(read_file(path) == good);
}

BOOST_AUTO_TEST_CASE(a_lock_is_waited_for) {
    Directory const directory;
    auto const file = directory.path / "a.h5";
    auto lock = std::make_unique<FileLock>(file, nullptr);
    BOOST_CHECK_THROW(FileLock(file, [] { return true; }), Interrupted);
    bool waited = false;
    {
        std::jthread const other([&] {
            FileLock const second(file, nullptr);
            waited = true;
        });
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        BOOST_TEST(!waited);
        lock.reset();
    }
    BOOST_TEST(waited);
    BOOST_TEST(!fs::exists(directory.path / "a.h5.lock"));
}

BOOST_AUTO_TEST_CASE(gnuplot_finds_nothing_to_execute) {
    Directory const directory;
    auto const victim = directory.path / "victim";
    put(directory.path / "style.gp", "");
    put(directory.path / "plot.gp",
        "set title title_text\nset label 1 caption at 0,0\nplot data using 1:2 title 'x'\n");
    for (std::string const& command :
         {fmt::format("`touch {}`", victim.string()), fmt::format("$(touch {})", victim.string()),
          fmt::format("'.system('touch {}').'", victim.string()),
          fmt::format("\"; system('touch {}')", victim.string())}) {
        // as a title, a caption, and as the beginning of names
        std::string name = command;
        std::replace(name.begin(), name.end(), '/', ' ');
        auto const out = directory.path / ("< " + name);
        fs::create_directories(out);
        put(out / "| data", "0 0\n1 1\n");
        draw(out / "| touch", directory.path / "plot.gp",
             fmt::format("title_text = {}\ncaption = {}\ndata = {}\n", quoted(command),
                         quoted(command + "\nsecond line"), quoted_path(out / "| data")));
        BOOST_TEST(fs::exists(out / "| touch.svg"));
        BOOST_TEST(fs::exists(out / "| touch.png"));
        BOOST_TEST(!parts_are_left(out));
        BOOST_TEST(!fs::exists(victim));
    }
}

// Every character, also before a digit that an escape could swallow.
BOOST_AUTO_TEST_CASE(gnuplot_has_texts_as_they_are) {
    Directory const directory;
    put(directory.path / "style.gp", "");
    put(directory.path / "plot.gp", "set print said\nprint text\nset print\nplot x\n");
    std::string text;
    for (char c = ' '; c <= '~'; ++c) text += {c, '7', c, '0', c};
    draw(directory.path / "picture", directory.path / "plot.gp",
         fmt::format("text = {}\nsaid = {}\n", dpd::quoted(text), quoted_path(directory.path / "said")));
    BOOST_TEST(read_file(directory.path / "said") == text + "\n");
}
