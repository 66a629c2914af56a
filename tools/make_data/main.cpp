// isochor_make_data DIRECTORY: writes the bundled models; the same bytes every time.
#include <exception>
#include <fstream>
#include <iostream>

#include "make_data/shapes.h"

namespace {

void write(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(path + ": cannot be written");
  std::cout << path << ": " << text.size() << " bytes\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: isochor_make_data DIRECTORY\n";
    return 2;
  }
  try {
    const std::string folder = std::string(argv[1]) + "/";
    write(folder + "fuselage.step", make_data::fuselage_step());
    write(folder + "fuselage12.step", make_data::fuselage12_step());
    write(folder + "hull.step", make_data::hull_step());
    write(folder + "half_hull.step", make_data::half_hull_step());
    write(folder + "cube.step", make_data::cube_step());
    write(folder + "patchwork.step", make_data::patchwork_step());
    write(folder + "canopy.step", make_data::canopy_step());
    write(folder + "cube.isochor.json", make_data::cube_json());
    write(folder + "cylinder.isochor.json", make_data::cylinder_json());
    write(folder + "torus.isochor.json", make_data::torus_json());
    write(folder + "spindle.isochor.json", make_data::spindle_json());
  } catch (const std::exception& error) {
    std::cerr << "isochor_make_data: " << error.what() << "\n";
    return 3;
  }
  return 0;
}
