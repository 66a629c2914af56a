// VolumeForm in the frame of a field: what turning the points may round.
#include <Eigen/Dense>
#include <cmath>

#include "isochor/volume/volume_form.h"

namespace isochor {

VolumeForm VolumeForm::local() const {
  VolumeForm same = *this;
  same.frame_ = {};
  return same;
}

double VolumeForm::frame_bound(const std::vector<Vec3>& points,
                               const std::vector<int>& moved) const {
  if (frame_.exact()) return 0.0;
  const Support support = support_of(moved);
  const std::vector<Vec3> rows = gradient(points, support);
  double sum = 0.0;
  for (size_t k = 0; k < rows.size(); ++k) {
    const Vec3& point = points[static_cast<size_t>(support.points[k])];
    // The gradient is turned: its lengths are not, but for the factors of a skew frame.
    sum += std::sqrt(3.0) * (frame_.matrix().transpose().inverse() * rows[k]).norm() *
           frame_.slip(point);
  }
  return 1.01 * sum;
}

}  // namespace isochor
