#include "pair_list.hpp"

#include <algorithm>

namespace dpd {

template <int d>
void PairList<d>::grow_to(std::size_t size) {
    if (size <= i.size()) return;
    std::size_t const capacity = std::max(size, i.size() + i.size() / 2);
    i.resize(capacity);
    j.resize(capacity);
    for (auto& component : unit) component.resize(capacity);
    distance.resize(capacity);
    impulse.resize(capacity);
}

template <int d>
std::size_t PairList<d>::bytes() const {
    return i.size() * (2 * sizeof(std::uint32_t) + (d + 2) * sizeof(double));
}

template struct PairList<2>;
template struct PairList<3>;

}  // namespace dpd
