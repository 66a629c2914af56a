// A software z-buffer: meshes and lines to pixels, without a display.
//
// Light: two soft lamps that move with the camera and an even sky; back faces are lit like front
// faces but darker and warmer, so that a surface turned inside out is noticed.
//
// Laws:
//  (1) the same input gives the same bits (one thread, fixed order);
//  (2) nearer surfaces hide farther ones whatever the order of drawing;
//  (3) triangles that share an edge cover every sample between them exactly once.
#pragma once

#include <cstdint>
#include <vector>

#include "isochor/io/image.h"
#include "isochor/picture/camera.h"
#include "isochor/picture/colour.h"

namespace isochor {

class Raster {
 public:
  static constexpr int kSamples = 3;  // samples a pixel, in each direction

  // The picture has the camera's size; throws PreconditionError when that is not usable.
  explicit Raster(const Camera& camera);

  // One colour (sRGB) for all, or, with a scale, the mesh's scalars turned into colours and thin
  // contour lines at the scale's ticks. Missing normals are averaged from the triangles.
  void draw(const Mesh& mesh, const Rgb& colour);
  void draw(const Mesh& mesh, const ColourScale& scale);
  // Lines hidden by what was drawn before are left out. Draw them after the meshes.
  void draw(const LineSet& lines);
  // A dot on the surface, `radius` in pixels.
  void dot(const Vec3& at, const Rgb& colour, double radius);
  // A thin dark line round every body, also where it stands before itself.
  void outline();

  // The mean of the samples, over a light background gradient.
  Image image() const;
  // True when something covers the middle of the pixel.
  bool covered(int x, int y) const;

 private:
  struct Vertex;
  void draw(const Mesh& mesh, const Rgb& colour, const ColourScale* scale);
  void draw_triangle(const Vertex& a, const Vertex& b, const Vertex& c, const Rgb& colour,
                     const ColourScale* scale);
  // `nearer`: how many pixels before its true depth it is drawn.
  void draw_segment(const Vec3& a, const Vec3& b, double half_width, double nearer,
                    std::vector<char>& stamp, const Rgb& colour, double opacity);
  // How far from a contour's value the scalar may be, to be within the contour line's width.
  static double contour_reach(const Vertex& a, const Vertex& b, const Vertex& c,
                              double doubled_area);
  Vec3 sample_position(const Vec3& p) const;
  size_t at(int x, int y) const { return static_cast<size_t>(y) * columns_ + x; }

  Camera camera_;
  int columns_ = 0, rows_ = 0;  // of samples
  std::vector<float> depth_;
  std::vector<std::array<float, 3>> light_;  // linear
};

}  // namespace isochor
