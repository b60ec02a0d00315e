// What the live pages have in the place of files: a page has none.
#include "configuration.hpp"
#include "errors.hpp"

namespace dpd {

Configuration read_configuration(std::string_view, std::string const& name, std::size_t, std::size_t) {
    throw InputError(name + ": cannot be read: a page has no files; allowed: another particles.start");
}

}  // namespace dpd
