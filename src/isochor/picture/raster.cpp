#include "isochor/picture/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isochor/base/error.h"

namespace isochor {
namespace {

constexpr float kNothing = -std::numeric_limits<float>::infinity();
// Lines are drawn this many pixels nearer than they are, or their own surface would hide them.
constexpr double kLineBias = 2.2;
// A step in depth of this many pixels between neighbours gets an outline.
constexpr double kOutlineStep = 9.0;
constexpr double kContourWidth = 0.8;  // pixels
constexpr double kContourShade = 0.72;
constexpr Rgb kInk = {0.16, 0.18, 0.21};

// A lamp in the camera's frame.
struct Lamp {
  Vec3 direction;
  double strength;
};

// How much light a unit normal n (camera frame) sends back; white is about 1.
double brightness(const Vec3& n) {
  static const Lamp key = {Vec3(-0.48, 0.62, 0.62).normalized(), 0.60};
  static const Lamp fill = {Vec3(0.70, -0.25, 0.66).normalized(), 0.26};
  const auto soft = [&n](const Lamp& lamp, double wrap) {
    return lamp.strength * std::max(0.0, (n.dot(lamp.direction) + wrap) / (1.0 + wrap));
  };
  return 0.31 + 0.10 * n.y() + soft(key, 0.25) + soft(fill, 0.10);
}

double highlight(const Vec3& n) {
  static const Vec3 half = (Vec3(-0.48, 0.62, 0.62).normalized() + Vec3::UnitZ()).normalized();
  const double c = std::max(0.0, n.dot(half));
  const double c2 = c * c, c4 = c2 * c2, c8 = c4 * c4, c16 = c8 * c8;
  return 0.10 * c16 * c8;
}

}  // namespace

struct Raster::Vertex {
  double x, y, depth;  // in samples
  Vec3 normal;         // in the camera's frame
  double scalar;
};

double Raster::contour_reach(const Vertex& a, const Vertex& b, const Vertex& c,
                             double doubled_area) {
  const double s1 = b.scalar - a.scalar, s2 = c.scalar - a.scalar;
  const double gx = s1 * (c.y - a.y) - s2 * (b.y - a.y);
  const double gy = s2 * (b.x - a.x) - s1 * (c.x - a.x);
  return 0.5 * kContourWidth * kSamples * std::hypot(gx, gy) / doubled_area;
}

Raster::Raster(const Camera& camera) : camera_(camera) {
  ISOCHOR_REQUIRE(1 <= camera.width && camera.width <= 8192, camera.width);
  ISOCHOR_REQUIRE(1 <= camera.height && camera.height <= 8192, camera.height);
  ISOCHOR_REQUIRE(camera.scale > 0.0 && std::isfinite(camera.scale), camera.scale);
  columns_ = kSamples * camera.width;
  rows_ = kSamples * camera.height;
  depth_.assign(static_cast<size_t>(columns_) * rows_, kNothing);
  light_.resize(depth_.size());
  const Rgb top = linear_from_srgb({0.975, 0.980, 0.986});
  const Rgb bottom = linear_from_srgb({0.885, 0.900, 0.918});
  for (int y = 0; y < rows_; ++y) {
    const double f = (y + 0.5) / rows_;
    std::array<float, 3> row;
    for (size_t c = 0; c < 3; ++c) row[c] = static_cast<float>(top[c] + f * (bottom[c] - top[c]));
    std::fill_n(light_.begin() + static_cast<std::ptrdiff_t>(at(0, y)), columns_, row);
  }
}

Vec3 Raster::sample_position(const Vec3& p) const {
  const Vec3 projected = camera_.project(p);
  return {kSamples * projected.x(), kSamples * projected.y(), projected.z()};
}

void Raster::draw(const Mesh& mesh, const Rgb& colour) { draw(mesh, colour, nullptr); }

void Raster::draw(const Mesh& mesh, const ColourScale& scale) {
  ISOCHOR_REQUIRE(mesh.scalars.size() == mesh.positions.size(), mesh.scalars.size());
  draw(mesh, Rgb{1.0, 1.0, 1.0}, &scale);
}

void Raster::draw(const Mesh& mesh, const Rgb& colour, const ColourScale* scale) {
  require_usable(mesh);
  if (mesh.normals.empty() && !mesh.empty()) {
    Mesh completed = mesh;
    complete_normals(completed);
    return draw(completed, colour, scale);
  }
  const Rgb base = linear_from_srgb(colour);
  std::vector<Vertex> vertices(mesh.positions.size());
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Vec3 p = sample_position(mesh.positions[i]);
    const Vec3& n = mesh.normals[i];
    vertices[i] = {p.x(), p.y(), p.z(),
                   Vec3(camera_.right.dot(n), camera_.up.dot(n), camera_.toward.dot(n)),
                   scale != nullptr ? mesh.scalars[i] : 0.0};
  }
  for (const auto& t : mesh.triangles) {
    draw_triangle(vertices[static_cast<size_t>(t[0])], vertices[static_cast<size_t>(t[1])],
                  vertices[static_cast<size_t>(t[2])], base, scale);
  }
}

namespace {

// Twice the signed area of (a, b, p); samples exactly on an edge belong to the triangle for which
// the edge runs upwards, or to the right when it is level.
struct EdgeTest {
  double ax, ay, dx, dy;
  bool owns_border;
  EdgeTest(double x0, double y0, double x1, double y1) : ax(x0), ay(y0), dx(x1 - x0), dy(y1 - y0) {
    owns_border = dy < 0.0 || (dy == 0.0 && dx > 0.0);
  }
  double value(double x, double y) const { return dx * (y - ay) - dy * (x - ax); }
  bool inside(double value) const { return value > 0.0 || (value == 0.0 && owns_border); }
};

// Both triangles at an edge must see the same rounding, so the edge is always taken the same way
// round and the sign is turned.
struct SharedEdge {
  EdgeTest test;
  double sign;
  SharedEdge(double x0, double y0, double x1, double y1)
      : test(swap(x0, y0, x1, y1) ? EdgeTest(x1, y1, x0, y0) : EdgeTest(x0, y0, x1, y1)),
        sign(swap(x0, y0, x1, y1) ? -1.0 : 1.0) {}
  static bool swap(double x0, double y0, double x1, double y1) {
    return x1 < x0 || (x1 == x0 && y1 < y0);
  }
  double value(double x, double y) const { return sign * test.value(x, y); }
  bool inside(double value) const {
    return value > 0.0 || (value == 0.0 && (sign > 0.0) == test.owns_border);
  }
};

}  // namespace

void Raster::draw_triangle(const Vertex& a, const Vertex& b_in, const Vertex& c_in,
                           const Rgb& colour, const ColourScale* scale) {
  const double turn = (b_in.x - a.x) * (c_in.y - a.y) - (b_in.y - a.y) * (c_in.x - a.x);
  if (turn == 0.0 || !std::isfinite(turn)) return;
  // With y downwards, counter-clockwise from outside means a negative turn.
  const bool front = turn < 0.0;
  const Vertex& b = front ? c_in : b_in;
  const Vertex& c = front ? b_in : c_in;
  const double doubled = std::abs(turn);
  const auto [x_low, x_high] = std::minmax({a.x, b.x, c.x});
  const auto [y_low, y_high] = std::minmax({a.y, b.y, c.y});
  if (x_high < 0.0 || y_high < 0.0 || x_low > columns_ || y_low > rows_) return;
  const int x0 = std::max(0, static_cast<int>(std::floor(x_low - 0.5)));
  const int y0 = std::max(0, static_cast<int>(std::floor(y_low - 0.5)));
  const int x1 = static_cast<int>(std::min<double>(columns_ - 1, std::ceil(x_high - 0.5)));
  const int y1 = static_cast<int>(std::min<double>(rows_ - 1, std::ceil(y_high - 0.5)));
  const double contour = scale != nullptr ? contour_reach(a, b, c, doubled) : 0.0;
  const SharedEdge ab(a.x, a.y, b.x, b.y), bc(b.x, b.y, c.x, c.y), ca(c.x, c.y, a.x, a.y);
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const double wc = ab.value(px, py), wa = bc.value(px, py), wb = ca.value(px, py);
      if (!ab.inside(wc) || !bc.inside(wa) || !ca.inside(wb)) continue;
      const double fa = wa / doubled, fb = wb / doubled, fc = wc / doubled;
      const auto z = static_cast<float>(fa * a.depth + fb * b.depth + fc * c.depth);
      float& nearest = depth_[at(x, y)];
      if (z <= nearest) continue;
      nearest = z;
      Vec3 n = fa * a.normal + fb * b.normal + fc * c.normal;
      const double length = n.norm();
      if (length > 0.0) n /= length;
      if (!front) n = -n;
      // Smooth normals may lean away from the viewer near an outline; light them as edge-on.
      if (n.z() < 0.0) n = Vec3(n.x(), n.y(), 0.0).normalized();
      Rgb base = colour;
      double lit = brightness(n), shine = highlight(n);
      if (scale != nullptr) {
        const double value = fa * a.scalar + fb * b.scalar + fc * c.scalar;
        base = scale->at(value);
        if (scale->near_tick(value, contour)) {
          for (double& channel : base) channel *= kContourShade;
        }
        lit = 0.34 + 0.66 * lit;
        shine *= 0.4;
      }
      if (!front) base = {0.62 * base[0], 0.50 * base[1], 0.42 * base[2]};
      auto& out = light_[at(x, y)];
      for (size_t k = 0; k < 3; ++k) out[k] = static_cast<float>(base[k] * lit + shine);
    }
  }
}

void Raster::draw(const LineSet& lines) {
  require_usable(lines);
  std::vector<char> stamp(depth_.size(), 0);
  const Rgb colour = linear_from_srgb(lines.colour);
  std::vector<Vec3> at_samples;
  at_samples.reserve(lines.points.size());
  for (const Vec3& p : lines.points) at_samples.push_back(sample_position(p));
  for (const auto& segment : lines.segments) {
    draw_segment(at_samples[static_cast<size_t>(segment[0])],
                 at_samples[static_cast<size_t>(segment[1])], 0.5 * kSamples * lines.width,
                 kLineBias, stamp, colour, lines.opacity);
  }
}

void Raster::dot(const Vec3& at, const Rgb& colour, double radius) {
  std::vector<char> stamp(depth_.size(), 0);
  const Vec3 p = sample_position(at);
  // A flat dot on a slanted surface sinks into it by up to twice its radius.
  draw_segment(p, p, kSamples * radius, kLineBias + 2.0 * radius, stamp, linear_from_srgb(colour),
               1.0);
}

void Raster::draw_segment(const Vec3& a, const Vec3& b, double half_width, double nearer,
                          std::vector<char>& stamp, const Rgb& colour, double opacity) {
  const double reach = half_width + 1.0;
  const auto [x_low, x_high] = std::minmax(a.x(), b.x());
  const auto [y_low, y_high] = std::minmax(a.y(), b.y());
  if (x_high < -reach || y_high < -reach || x_low > columns_ + reach || y_low > rows_ + reach) {
    return;
  }
  const double bias = nearer / camera_.scale;
  const double dx = b.x() - a.x(), dy = b.y() - a.y();
  const double length2 = dx * dx + dy * dy;
  const int y0 = std::max(0, static_cast<int>(std::floor(y_low - reach)));
  const int y1 = static_cast<int>(std::min<double>(rows_ - 1, std::ceil(y_high + reach)));
  for (int y = y0; y <= y1; ++y) {
    // The stretch of this row that the line can touch.
    double from = x_low, to = x_high;
    if (std::abs(dy) > 1e-9) {
      const double s0 = std::clamp((y + 0.5 - reach - a.y()) / dy, 0.0, 1.0);
      const double s1 = std::clamp((y + 0.5 + reach - a.y()) / dy, 0.0, 1.0);
      from = a.x() + std::min(s0 * dx, s1 * dx);
      to = a.x() + std::max(s0 * dx, s1 * dx);
    }
    const int x0 = static_cast<int>(std::max(0.0, std::floor(from - reach)));
    const int x1 = static_cast<int>(std::min<double>(columns_ - 1, std::ceil(to + reach)));
    for (int x = x0; x <= x1; ++x) {
      const double px = x + 0.5 - a.x(), py = y + 0.5 - a.y();
      const double s = length2 > 0.0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
      const double ex = px - s * dx, ey = py - s * dy;
      if (ex * ex + ey * ey > half_width * half_width) continue;
      const size_t here = at(x, y);
      const double z = a.z() + s * (b.z() - a.z()) + bias;
      if (stamp[here] != 0 || z < depth_[here]) continue;
      stamp[here] = 1;
      auto& out = light_[here];
      for (size_t k = 0; k < 3; ++k) {
        out[k] = static_cast<float>(out[k] + opacity * (colour[k] - out[k]));
      }
    }
  }
}

void Raster::outline() {
  const Rgb ink = linear_from_srgb(kInk);
  const auto step = static_cast<float>(kOutlineStep / camera_.scale);
  const int reach = kSamples / 2 + 1;
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      const float own = depth_[at(x, y)];
      if (own == kNothing) continue;
      bool edge = false;
      for (const auto& [dx, dy] : {std::pair(reach, 0), {-reach, 0}, {0, reach}, {0, -reach}}) {
        const int nx = x + dx, ny = y + dy;
        if (nx < 0 || ny < 0 || nx >= columns_ || ny >= rows_) continue;
        edge = edge || own - depth_[at(nx, ny)] > step;
      }
      if (!edge) continue;
      auto& out = light_[at(x, y)];
      for (size_t k = 0; k < 3; ++k) {
        out[k] = static_cast<float>(out[k] + 0.72 * (ink[k] - out[k]));
      }
    }
  }
}

Image Raster::image() const {
  Image out(camera_.width, camera_.height);
  for (int y = 0; y < camera_.height; ++y) {
    for (int x = 0; x < camera_.width; ++x) {
      Rgb sum = {0.0, 0.0, 0.0};
      for (int sy = 0; sy < kSamples; ++sy) {
        for (int sx = 0; sx < kSamples; ++sx) {
          const auto& light = light_[at(kSamples * x + sx, kSamples * y + sy)];
          // Clipped before averaging, or one bright sample would fray the edge of its neighbour.
          for (size_t k = 0; k < 3; ++k) sum[k] += std::min(1.0f, light[k]);
        }
      }
      for (double& c : sum) c /= kSamples * kSamples;
      const Rgb srgb = srgb_from_linear(sum);
      for (size_t k = 0; k < 3; ++k) {
        out.pixel(x, y)[k] = static_cast<std::uint8_t>(std::lround(255.0 * srgb[k]));
      }
    }
  }
  return out;
}

bool Raster::covered(int x, int y) const {
  ISOCHOR_REQUIRE(0 <= x && x < camera_.width && 0 <= y && y < camera_.height, x, y);
  return depth_[at(kSamples * x + kSamples / 2, kSamples * y + kSamples / 2)] != kNothing;
}

}  // namespace isochor
