#include "isochor/picture/edit_picture.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/error.h"
#include "isochor/picture/page.h"

namespace isochor {
namespace {

using internal::kLabelHeight;
using internal::kLegendHeight;
using internal::kLineHeight;
using internal::kMargin;
using internal::kTitleHeight;
using internal::Page;
using internal::View;

constexpr double kWideModel = 1.75;   // from this aspect on, views stand one above the other
constexpr double kSmallRegion = 0.5;  // of the model: below, a close-up is added
constexpr double kMovedShare = 0.02;  // of the largest displacement: counts as moved
constexpr double kPanelMargin = 18.0;

Camera camera_for(const Mesh& mesh, const std::optional<Focus>& focus, const Vec3& up) {
  const Vec3 toward =
      focus ? view_of_focus(mesh, focus->point, focus->normal, up) : three_quarter_view(up);
  return look_along(toward, up);
}

// Close by, a bulge shows best from half way between the view of the whole and its own normal: from
// the side it is a line on the horizon, from above it is flat.
Camera close_camera(const Camera& whole, const std::optional<Focus>& focus, const Vec3& up) {
  return focus ? look_along(whole.toward + focus->normal.normalized(), up) : whole;
}

std::vector<Vec3> used_positions(const Mesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  std::vector<Vec3> points;
  for (const auto& t : mesh.triangles) {
    for (int i : t) {
      if (used[static_cast<size_t>(i)] != 0) continue;
      used[static_cast<size_t>(i)] = 1;
      points.push_back(mesh.positions[static_cast<size_t>(i)]);
    }
  }
  return points;
}

std::vector<Vec3> joined(std::vector<Vec3> a, const std::vector<Vec3>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Positions before and after of what moved noticeably.
std::vector<Vec3> moved_positions(const Mesh& before, const Mesh& after) {
  double largest = 0.0;
  for (size_t i = 0; i < before.positions.size(); ++i) {
    largest = std::max(largest, (after.positions[i] - before.positions[i]).norm());
  }
  std::vector<Vec3> moved;
  for (size_t i = 0; largest > 0.0 && i < before.positions.size(); ++i) {
    if ((after.positions[i] - before.positions[i]).norm() < kMovedShare * largest) continue;
    moved.push_back(before.positions[i]);
    moved.push_back(after.positions[i]);
  }
  return moved;
}

Frame2d enlarged(const Frame2d& frame, double factor) {
  const double dx = 0.5 * (factor - 1.0) * frame.width(),
               dy = 0.5 * (factor - 1.0) * frame.height();
  return {frame.right_min - dx, frame.right_max + dx, frame.up_min - dy, frame.up_max + dy};
}

double aspect(const Frame2d& frame) {
  return std::clamp(frame.width() / std::max(frame.height(), 1e-3 * frame.width() + 1e-300), 0.4,
                    5.0);
}

ColourScale scale_for(const std::vector<double>& values) {
  double largest = 0.0;
  for (double value : values) largest = std::max(largest, std::abs(value));
  return ColourScale(largest > 1e-300 ? largest : 1.0);
}

// Where panels stand: a grid of columns and rows below the title.
struct Grid {
  std::vector<int> widths, heights;
  int top = 0;
  int x(size_t column) const {
    int at = kMargin;
    for (size_t k = 0; k < column; ++k) at += widths[k] + kMargin;
    return at;
  }
  int y(size_t row) const {
    int at = top;
    for (size_t k = 0; k <= row; ++k) at += kLabelHeight + (k < row ? heights[k] : 0);
    return at;
  }
  int bottom() const { return y(heights.size() - 1) + heights.back(); }
};

int footer_height(size_t caption_lines, bool legend) {
  const int caption = static_cast<int>(caption_lines) * kLineHeight;
  return std::max(caption, legend ? kLegendHeight : 0) + kMargin;
}

// Stretches the rows of `grid` so that the page gets the wanted height (0: leaves them).
int settle_height(Grid& grid, int footer, int wanted) {
  const int natural = grid.bottom() + footer;
  if (wanted == 0) return natural;
  int rows = 0;
  for (int height : grid.heights) rows += height;
  const double factor = static_cast<double>(wanted - natural + rows) / rows;
  for (int& height : grid.heights) height = static_cast<int>(height * factor);
  ISOCHOR_REQUIRE(grid.heights.front() >= 3 * kPanelMargin, wanted);
  return wanted;
}

void finish(Page& page, const Grid& grid, const std::vector<std::string>& caption,
            const ColourScale* scale, const std::string& heading) {
  const int y = grid.bottom() + 4;
  const int width = page.image().width;
  const int bar = std::min(620, width / 2 - kMargin);
  const int text = scale != nullptr ? width - bar - 3 * kMargin : width - 2 * kMargin;
  page.caption(kMargin, y, text, caption);
  if (scale != nullptr) page.legend(width - kMargin - bar, y, bar, *scale, heading);
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " [" + unit + "]";
}

void require_size(const PictureSize& size) {
  ISOCHOR_REQUIRE(320 <= size.width && size.width <= 8000, size.width);
  ISOCHOR_REQUIRE(size.height == 0 || (240 <= size.height && size.height <= 8000), size.height);
}

// The grid of an edit's picture: kinds (before, after, displacement) in columns and close-ups
// below, or, for wide models, kinds in rows and close-ups beside.
Grid edit_grid(const PictureSize& size, double shape, bool wide, bool close_up, int top) {
  Grid grid;
  grid.top = top;
  const int room = size.width - 2 * kMargin;
  if (wide) {
    const double near = close_up ? std::min(0.3, 1.35 / shape) : 0.0;
    const int side = close_up ? static_cast<int>(near * room) : 0;
    grid.widths.push_back(room - side - (close_up ? kMargin : 0));
    if (close_up) grid.widths.push_back(side);
    const int height =
        static_cast<int>((grid.widths[0] - 2 * kPanelMargin) / shape + 2 * kPanelMargin);
    grid.heights.assign(3, std::clamp(height, 160, 620));
  } else {
    const int column = (room - 2 * kMargin) / 3;
    grid.widths.assign(3, column);
    const int height =
        std::clamp(static_cast<int>(column / shape), column * 6 / 10, column * 5 / 4);
    grid.heights.push_back(height);
    if (close_up) grid.heights.push_back(column * 3 / 4);
  }
  return grid;
}

}  // namespace

std::vector<double> normal_displacement(const Mesh& before, const Mesh& after) {
  ISOCHOR_REQUIRE(before.positions.size() == after.positions.size(), before.positions.size(),
                  after.positions.size());
  ISOCHOR_REQUIRE(before.normals.size() == before.positions.size(), before.normals.size());
  std::vector<double> values;
  values.reserve(before.positions.size());
  for (size_t i = 0; i < before.positions.size(); ++i) {
    values.push_back((after.positions[i] - before.positions[i]).dot(before.normals[i]));
  }
  return values;
}

Image edit_picture(const PictureInput& input, const PictureSize& size) {
  require_size(size);
  ISOCHOR_REQUIRE(!input.before.empty());
  ISOCHOR_REQUIRE(input.before.triangles == input.after.triangles);
  Mesh before = input.before;
  complete_normals(before);
  Mesh heat = input.after;
  heat.scalars = normal_displacement(before, input.after);
  const ColourScale scale = scale_for(heat.scalars);

  const Camera direction = camera_for(input.before, input.focus, input.up);
  const Frame2d whole =
      covered(direction, joined(used_positions(input.before), used_positions(input.after)));
  const std::vector<Vec3> moved = moved_positions(input.before, input.after);
  const Camera close_direction = close_camera(direction, input.focus, input.up);
  Frame2d near = whole;
  if (!moved.empty()) near = enlarged(covered(close_direction, moved), 1.3);
  const bool close_up = near.width() < kSmallRegion * whole.width() &&
                        near.height() < kSmallRegion * std::max(whole.height(), whole.width() / 3);
  const double shape = aspect(whole);
  const bool wide = shape > kWideModel;

  Grid grid =
      edit_grid(size, shape, wide, close_up, input.title.empty() ? kMargin / 2 : kTitleHeight);
  const int height = settle_height(grid, footer_height(input.caption.size(), true), size.height);
  Page page(size.width, height);
  page.title(input.title);
  const char* labels[] = {"before", "after", "displacement"};
  const Mesh* meshes[] = {&before, &input.after, &heat};
  for (size_t kind = 0; kind < 3; ++kind) {
    View view;
    view.mesh = meshes[kind];
    view.lines = kind == 0 ? &input.before_lines : &input.after_lines;
    if (kind == 2) view.scale = &scale;
    if (kind == 0) view.moves = input.moves;
    for (const auto& move : input.moves) {
      if (kind == 1) view.dots.push_back(move.second);
    }
    for (size_t part = 0; part < (close_up ? 2u : 1u); ++part) {
      const size_t column = wide ? part : kind, row = wide ? kind : part;
      view.label = labels[kind] + std::string(part == 1 ? ", close" : "");
      view.camera = fit(part == 1 ? close_direction : direction, part == 1 ? near : whole,
                        grid.widths[column], grid.heights[row], kPanelMargin);
      page.panel(grid.x(column), grid.y(row), view);
    }
  }
  finish(page, grid, input.caption, &scale,
         with_unit("displacement along the normal: blue inward, red outward", input.unit));
  return page.image();
}

Image model_picture(const ModelPictureInput& input, const PictureSize& size) {
  require_size(size);
  ISOCHOR_REQUIRE(!input.mesh.empty());
  const Camera direction = camera_for(input.mesh, input.focus, input.up);
  const Frame2d whole = covered(direction, used_positions(input.mesh));
  Grid grid;
  grid.top = input.title.empty() ? 0 : kTitleHeight - kLabelHeight / 2;
  grid.widths = {size.width - 2 * kMargin};
  grid.heights = {std::clamp(static_cast<int>(grid.widths[0] / aspect(whole)), size.width / 4,
                             size.width * 3 / 4)};
  const int height = settle_height(grid, footer_height(input.caption.size(), false), size.height);
  Page page(size.width, height);
  page.title(input.title);
  View view;
  view.mesh = &input.mesh;
  view.lines = &input.lines;
  view.camera = fit(direction, whole, grid.widths[0], grid.heights[0], kPanelMargin + 8.0);
  page.panel(grid.x(0), grid.y(0), view);
  finish(page, grid, input.caption, nullptr, "");
  return page.image();
}

Image deviation_picture(const DeviationPictureInput& input, const PictureSize& size) {
  require_size(size);
  ISOCHOR_REQUIRE(!input.mesh.empty());
  const ColourScale scale = scale_for(input.mesh.scalars);
  const Camera front = camera_for(input.mesh, input.focus, input.up);
  // From behind: the eye turned half way round the upright axis.
  const Vec3 axis = input.up.normalized();
  const Vec3 behind = 2.0 * axis.dot(front.toward) * axis - front.toward;
  const Camera back = look_along(behind, input.up);
  const std::vector<Vec3> points = used_positions(input.mesh);
  const Frame2d seen[2] = {covered(front, points), covered(back, points)};
  const double shape = std::max(aspect(seen[0]), aspect(seen[1]));
  const bool wide = shape > kWideModel;
  Grid grid;
  grid.top = input.title.empty() ? kMargin / 2 : kTitleHeight;
  const int room = size.width - 2 * kMargin;
  grid.widths.assign(wide ? 1 : 2, wide ? room : (room - kMargin) / 2);
  grid.heights.assign(wide ? 2 : 1,
                      std::clamp(static_cast<int>(grid.widths[0] / shape), 160, grid.widths[0]));
  const int height = settle_height(grid, footer_height(input.caption.size(), true), size.height);
  Page page(size.width, height);
  page.title(input.title);
  for (size_t k = 0; k < 2; ++k) {
    const size_t column = wide ? 0 : k, row = wide ? k : 0;
    View view;
    view.label = k == 0 ? "deviation" : "deviation, from behind";
    view.mesh = &input.mesh;
    view.lines = &input.lines;
    view.scale = &scale;
    view.camera =
        fit(k == 0 ? front : back, seen[k], grid.widths[column], grid.heights[row], kPanelMargin);
    page.panel(grid.x(column), grid.y(row), view);
  }
  finish(page, grid, input.caption, &scale,
         with_unit("deviation along the normal: blue inward, red outward", input.unit));
  return page.image();
}

}  // namespace isochor
