/// @file
/// HDF5 files, written whole or not at all.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace dpd {

/// A file open for reading or for writing. The same call, `archive("group/name", value)`, stores or restores
/// a value, so that one function describes both directions. What is written is in memory until `commit`, and
/// ends with a digest of all bytes, which reading checks; files of others, and of earlier versions, have
/// none. Errors: InputError naming the file; Damaged if it is not as it was written.
class Archive {
public:
    /// What the same calls do.
    enum class Mode {
        read,   ///< restore from the file
        write,  ///< store, in memory until `commit`
    };
    /// Opens `path`; reading checks its digest.
    Archive(std::filesystem::path path, Mode mode);
    ~Archive();
    Archive(Archive const&) = delete;
    Archive& operator=(Archive const&) = delete;

    /// Whether the file ends like one of ours, whole or damaged.
    static bool is_ours(std::filesystem::path const& path);

    /// Damaged: the file holds a value that cannot be, or not here.
    [[noreturn]] void refuse(std::string const& name, std::string const& problem) const;

    /// Whether values are restored.
    bool reading() const { return mode_ == Mode::read; }
    /// Whether the file has that value; of a file that is read.
    bool has(std::string const& name) const;

    /// Names of the H5MD observables that are one number per sample.
    std::vector<std::string> observables() const;

    /// Stores or restores a value.
    void operator()(std::string const& name, double& value);
    /// The same for a whole number.
    void operator()(std::string const& name, std::uint64_t& value);
    /// The same for a text.
    void operator()(std::string const& name, std::string& value);
    /// The same for a list of any length.
    void operator()(std::string const& name, std::vector<double>& values);
    /// The same for whole numbers.
    void operator()(std::string const& name, std::vector<std::uint64_t>& values);
    /// The same for an array, rows x columns; reading sets the number of rows.
    template <class Scalar, int columns, int options>
    void operator()(std::string const& name, Eigen::Array<Scalar, Eigen::Dynamic, columns, options>& values) {
        array(name, values);
    }

    /// Adds the root group that makes the file's observables readable as H5MD (write only).
    void describe_as_h5md();

    /// Adds the H5MD time axis of the observable `name`, sampled every `interval` steps from `first_step` on
    /// (write only).
    void describe_time(std::string const& name, std::uint64_t first_step, std::uint64_t interval,
                       double time_step);

    /// Writes the finished file, whole or not at all.
    void commit();

private:
    template <class Scalar, int columns, int options>
    void array(std::string const& name, Eigen::Array<Scalar, Eigen::Dynamic, columns, options>& values);

    struct File;
    std::unique_ptr<File> file_;
    std::filesystem::path path_;
    Mode mode_;
};

}  // namespace dpd
