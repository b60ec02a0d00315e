// Particles from a file: the same from each of its forms, a run that goes on where another has ended, and one
// line for what cannot be taken.
#define BOOST_TEST_MODULE configuration
#include "configuration.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <boost/test/unit_test.hpp>
#include <filesystem>
#include <fstream>
#include <functional>

#include "errors.hpp"
#include "files.hpp"
#include "run.hpp"
#include "scene.hpp"

using namespace dpd;

namespace {

struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("dpdref_configuration_test." + std::to_string(::getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    std::filesystem::path write(std::string const& name, std::string const& text) const {
        std::ofstream(path / name, std::ios::binary) << text;
        return path / name;
    }
} const folder;

// A potential and nothing else: what follows depends on the particles alone.
std::string const hamiltonian = R"(
dimension = 3
stages = ["sample", "verlet"]
box.length = [5.0, 4.0, 4.5]
particles.number = 200
particles.kT = 1.3
verlet.soft.strength = 12.0
sample.observables = ["kinetic_temperature"]
pairs.order = "id"
)";

std::string timed(int steps, int frames) {
    return fmt::format("time.step = 0.01\ntime.duration = {}\ntrajectory.interval = {}\n", 0.01 * steps,
                       frames);
}

// Runs a scene into a file of that name; the bytes of its trajectory.
std::string trajectory_of(std::string const& text, std::string const& name) {
    RunOptions options;
    options.output = folder.path / (name + ".h5");
    run(parse_scene(text, (folder.path / "scene.toml").string()), options);
    return read_file(folder.path / (name + ".h5md"));
}

Configuration frame(std::string const& bytes) { return read_configuration(bytes, "x.h5md", 200, 3); }

double largest_difference(std::vector<double> const& a, std::vector<double> const& b) {
    BOOST_REQUIRE_EQUAL(a.size(), b.size());
    double worst = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
    return worst;
}

// Three particles in two dimensions, once more in every form; particle 2 stands before particle 1.
std::string const xyz = "1\nnot this frame Lattice=\"9 0 0 0 9 0 0 0 9\"\nA 0 0 0\n";
std::string const extended =
    "3\nLattice=\"4.0 0 0 0 5.0 0 0 0 1.0\" Origin=\"-2 -2.5 0\" "
    "Properties=species:S:1:id:I:1:pos:R:3:velo:R:3 Time=3\n"
    "A 1 -1.5 -2.25 0 0.5 0.25 0\nA 3 -1.0 2.25 0 -0.5 -1.25 0\nA 2 1.75 0.5 0 1.5 0.125 0\n";
std::string const lammps =
    "LAMMPS data\n\n3 atoms\n1 atom types\n\n-2 2 xlo xhi\n-2.5 2.5 ylo yhi\n-0.5 0.5 zlo zhi\n\nMasses\n\n1 "
    "1.0\n\n"
    "Atoms # full\n\n1 1 1 0.0 -1.5 -2.25 0\n3 1 1 0.0 -1.0 2.25 0 0 0 0\n2 1 1 0.0 1.75 0.5 0\n\n"
    "Velocities\n\n3 -0.5 -1.25 0\n2 1.5 0.125 0\n1 0.5 0.25 0\n";
std::string const gas =
    "dimension = 2\nstages = [\"shardlow\", \"sample\", \"drift\"]\nshardlow.friction = 1.0\nbox.length = "
    "[4.0, 5.0]\n"
    "particles.number = 3\nparticles.start = \"file\"\ntime.step = 0.01\ntime.duration = 0.1\n";

Scene scene_of(std::string const& name, std::string const& text = gas) {
    return parse_scene(text + fmt::format("particles.file = \"{}\"\n", name),
                       (folder.path / "s.toml").string());
}

}  // namespace

// Twenty steps and ten more from their last frame are thirty: positions and velocities to the last bit.
BOOST_AUTO_TEST_CASE(a_run_goes_on_from_the_last_frame_of_another) {
    std::string const twenty = trajectory_of(hamiltonian + timed(20, 10), "twenty"),
                      thirty = trajectory_of(hamiltonian + timed(30, 10), "thirty"),
                      ten =
                          trajectory_of(hamiltonian + timed(10, 10) +
                                            "particles.start = \"file\"\nparticles.file = \"twenty.h5md\"\n",
                                        "ten");
    BOOST_TEST(largest_difference(frame(ten).position, frame(thirty).position) == 0.0);
    BOOST_TEST(largest_difference(frame(ten).velocity, frame(thirty).velocity) == 0.0);
    BOOST_TEST(largest_difference(frame(ten).position, frame(twenty).position) > 0.01);
    BOOST_TEST((frame(twenty).length == std::vector{5.0, 4.0, 4.5}));
}

BOOST_AUTO_TEST_CASE(every_form_gives_the_same) {
    std::vector<double> const position{0.5, 0.25, 3.75, 3.0, 1.0, 4.75},
        velocity{0.5, 0.25, 1.5, 0.125, -0.5, -1.25};
    for (auto const& [name, bytes] :
         {std::pair<std::string, std::string>{"a.xyz", extended}, {"a.data", lammps}}) {
        auto const state = read_configuration(bytes, name, 3, 2);
        BOOST_TEST((state.length == std::vector{4.0, 5.0}));
        BOOST_TEST((state.position == position), name);
        BOOST_TEST((state.velocity == velocity), name);
        folder.write(name, bytes);
        auto const scene = scene_of(name);
        auto const simulation = build<2>(scene, {});
        BOOST_TEST(simulation.particles.position(2, 1) == 4.75);
        BOOST_TEST(simulation.particles.velocity(1, 0) == 1.5);
    }
    // the last frame counts, and what has no velocities gets some
    std::string const still =
        "3\nLattice=\"4.0 0 0 0 5.0 0 0 0 1.0\"\nA 0.5 -4.75 0\nA 3.75 3 0\nA 1 4.75 0\n";
    folder.write("b.xyz", extended + still + "\n");
    auto const simulation = build<2>(scene_of("b.xyz"), {});
    BOOST_TEST(simulation.particles.position(0, 1) == 0.25);
    BOOST_TEST(simulation.particles.velocity(0, 0) != 0.0);
}

// The content belongs to the key of a result, and the digest in the scene that a result keeps holds the file
// to it.
BOOST_AUTO_TEST_CASE(the_content_is_part_of_the_key) {
    folder.write("c.xyz", extended);
    auto const first = scene_of("c.xyz");
    BOOST_TEST(first.key() == scene_of("c.xyz").key());
    BOOST_TEST(first.key() == parse_scene(first.text, (folder.path / "s.toml").string()).key());
    std::string other = extended;
    other.replace(other.find("1.75"), 4, "1.25");
    folder.write("c.xyz", other);
    BOOST_TEST(first.key() != scene_of("c.xyz").key());
    BOOST_CHECK_EXCEPTION(
        parse_scene(first.text, (folder.path / "s.toml").string()), InputError, [](InputError const& error) {
            BOOST_TEST_MESSAGE(error.what());
            return std::string(error.what()).find("the file that it was") != std::string::npos;
        });
}

BOOST_AUTO_TEST_CASE(bad_files_get_one_line) {
    auto const refused = [](std::string const& name, std::string const& bytes, std::string const& why) {
        folder.write(name, bytes);
        BOOST_CHECK_EXCEPTION(scene_of(name), InputError, [&](InputError const& error) {
            std::string const line = error.what();
            BOOST_TEST_MESSAGE(line);
            return line.find(why) != std::string::npos && line.find('\n') == std::string::npos;
        });
    };
    auto const changed = [](std::string text, std::string const& what, std::string const& by) {
        return text.replace(text.find(what), what.size(), by);
    };
    refused("d.xyz", "", "has no frame");
    refused("d.xyz", xyz, "has 1 particles; allowed: those of the scene, 3");
    refused("d.xyz", "3\nno box\nA 0 0 0\n", "d.xyz:2: has no box");
    refused("d.xyz", extended.substr(0, extended.find("0.5 0.25")), "d.xyz:3: has 5 columns; allowed: at least 7");
    refused("d.xyz", extended.substr(0, extended.rfind("A 2")), "ends in line 4; allowed: a whole frame");
    refused("d.xyz", changed(extended, "4.0 0 0", "4.0 1 0"), "leans");
    refused("d.xyz", changed(extended, "4.0 0 0", "4.5 0 0"),
            "has a box of 4.5 x 5; allowed: that of the scene, 4 x 5");
    refused("d.xyz", changed(extended, "1.75", "nan"), "'nan' is no finite number");
    refused("d.xyz", changed(extended, "A 2", "A 1"), "has id 1 twice");
    refused("d.xyz", changed(extended, ":pos:", ":force:"), "has no pos");
    refused("d.data", "", "ends in line 0");
    refused("d.data", changed(lammps, "3 atoms", "4 atoms"), "has 4 particles");
    refused("d.data", changed(lammps, "full", "sphere"), "style 'sphere'");
    refused("d.data", changed(lammps, "xlo xhi", "alo ahi"), "has no xlo xhi");
    refused("d.data", changed(lammps, "\n2 1 1 0.0 1.75", "\n2 1 1 0.0 x"), "'x' is no finite number");
    refused("d.data", changed(lammps, "3 -0.5", "4 -0.5"), "has other ids in Velocities");
    refused("d.data", lammps.substr(0, lammps.find("Atoms")), "has no section Atoms");
    refused("d.data", lammps.substr(0, lammps.find("2 1 1 0.0")), "ends in line");
    refused("d.h5", "no hdf5", "d.h5: cannot read");
    refused("d.h5md", trajectory_of(hamiltonian + timed(10, 10), "short"), "allowed: at least one frame of");
    refused("d.pdb", extended, "is of no kind that is read; allowed: .h5");
    BOOST_CHECK_THROW(scene_of("not-there.xyz"), InputError);
    BOOST_CHECK_THROW(parse_scene(gas, "s.toml"), InputError);  // no file
    BOOST_CHECK_THROW(parse_scene(gas + "particles.file = \"d.xyz\"\nwalls.thickness = 1.0\n", "s.toml"),
                      InputError);
}
