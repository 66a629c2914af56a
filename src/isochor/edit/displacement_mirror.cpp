// Mirror symmetry of a DisplacementSpace: two mirror images become one coefficient.
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <type_traits>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/edit/displacement_space.h"
#include "isochor/edit/mirror.h"

namespace isochor {

// Makes every coefficient and its mirror image one coefficient with one flipped axis; a coefficient
// on the plane keeps its place on it.
void DisplacementSpace::mirror(const PatchModel& model, int axis) {
  const double tolerance = kCoincident * diagonal(model);
  const std::vector<int> image = mirror_images(places_, axis, tolerance, patch_of_);
  check_mirror(model, axis, image);
  const unsigned bit = 1u << axis;
  const size_t count = places_.size();
  std::vector<int> leader(count);
  std::vector<int> number(count, -1);
  int kept = 0;
  for (size_t c = 0; c < count; ++c) {
    leader[c] = std::min(static_cast<int>(c), image[c]);
    if (leader[c] == static_cast<int>(c)) number[c] = kept++;
  }
  const DisplacementSpace old = *this;
  const auto shrink = [&](auto& values) {
    std::remove_reference_t<decltype(values)> smaller;
    for (size_t c = 0; c < count; ++c) {
      if (number[c] >= 0) smaller.push_back(values[c]);
    }
    values = std::move(smaller);
  };
  shrink(places_);
  shrink(weights_);
  shrink(patch_of_);
  shrink(locked_axes_);
  shrink(lock_reason_of_);
  neighbours_.assign(static_cast<size_t>(kept), {});
  for (size_t c = 0; c < count; ++c) {
    const int target = number[static_cast<size_t>(leader[c])];
    auto& around = neighbours_[static_cast<size_t>(target)];
    for (int other : old.neighbours_[c]) {
      const int mapped = number[static_cast<size_t>(leader[static_cast<size_t>(other)])];
      if (mapped != target) around.push_back(mapped);
    }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    if (static_cast<int>(c) == image[c]) {
      lock_coefficient(target, bit, kOnSymmetry);
    } else if (leader[c] != static_cast<int>(c)) {
      weights_[static_cast<size_t>(target)] += old.weights_[c];
      if (old.locked_axes_[c] != 0) {
        lock_coefficient(target, old.locked_axes_[c], old.lock_reason(static_cast<int>(c)));
      }
    }
  }
  for (Entry& entry : entries_) {
    const auto c = static_cast<size_t>(entry.coefficient);
    if (leader[c] != entry.coefficient) entry.flipped ^= bit;
    entry.coefficient = number[static_cast<size_t>(leader[c])];
  }
}

// The patch of the coefficient that a row of F has most of.
int DisplacementSpace::patch_of_row(size_t row) const {
  const auto largest = std::max_element(
      rows_[row].begin(), rows_[row].end(),
      [](const auto& a, const auto& b) { return std::abs(a.value) < std::abs(b.value); });
  return patch_of(entries_[static_cast<size_t>(largest->entry)].coefficient);
}

// The rows of mirrored points must be mirrored rows, or "symmetric" would not be true of the shape.
void DisplacementSpace::check_mirror(const PatchModel& model, int axis,
                                     const std::vector<int>& image) {
  const double tolerance = kCoincident * diagonal(model);
  const char name = static_cast<char>('x' + axis);
  for (size_t c = 0; c < image.size(); ++c) {
    if (image[c] >= 0) continue;
    const Patch& patch = model.patches[static_cast<size_t>(patch_of_[c])];
    std::ostringstream text;
    text << "the place (" << places_[c].transpose() << ") of patch " << patch.handle
         << " has no mirror image across the plane " << name << " = 0 within " << tolerance;
    throw InputError("", std::string("hold symmetry \"") + name + "\"", text.str());
  }
  std::vector<Vec3> positions(rows_.size(), Vec3::Zero());
  std::vector<char> used(rows_.size(), 0);
  std::vector<int> groups(rows_.size(), -1);
  for (size_t c = 0; c < rows_.size(); ++c) {
    if (!rows_[c].empty()) groups[c] = patch_of_row(c);
  }
  for (const Patch& patch : model.patches) {
    for (int id : patch.points) {
      const auto c = static_cast<size_t>(class_of_point_[static_cast<size_t>(id)]);
      positions[c] = model.points[static_cast<size_t>(id)];
      used[c] = 1;
    }
  }
  const std::vector<int> point_image = mirror_images(positions, axis, tolerance, groups);
  for (size_t c = 0; c < rows_.size(); ++c) {
    if (!used[c]) continue;
    std::map<int, double> difference;
    bool same = point_image[c] >= 0;
    if (same) {
      for (const RowTerm& term : rows_[c]) {
        const int k = entries_[static_cast<size_t>(term.entry)].coefficient;
        difference[image[static_cast<size_t>(k)]] += term.value;
      }
      for (const RowTerm& term : rows_[static_cast<size_t>(point_image[c])]) {
        difference[entries_[static_cast<size_t>(term.entry)].coefficient] -= term.value;
      }
      for (const auto& item : difference) same = same && std::abs(item.second) <= kSameRow;
    }
    if (!same) {
      std::ostringstream text;
      text << "the control point (" << positions[c].transpose()
           << ") has no mirror image across the plane " << name << " = 0";
      throw InputError("", std::string("hold symmetry \"") + name + "\"", text.str());
    }
  }
}

}  // namespace isochor
