// Remakes the figures of docs/ecles_thesis.md.
//
// usage: isochor_thesis_figures OUTDIR [--matrices N]
// Writes an SVG and a CSV file for each figure; N random matrices for each point (default 200).
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

#include "figures/bit_growth.h"
#include "figures/floating_rank.h"
#include "figures/plot.h"

namespace {

constexpr int kDefaultMatrices = 200;

int run(const std::string& folder, int matrices) {
  using figures::write_file;
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& name, const figures::Plot& plot) {
    write_file(folder + "/" + name + ".svg", figures::to_svg(plot));
    write_file(folder + "/" + name + ".csv", figures::to_csv(plot));
    std::cout << name << ": " << plot.title << std::endl;
  };
  const figures::FloatingRank floating = figures::compare_floating_rank();
  write_file(folder + "/figure_2_3.svg", floating.picture);
  std::cout << "figure_2_3: " << floating.summary << std::endl;
  write("figure_2_3_rank", floating.ranks);
  for (const auto& [name, plot] : figures::bit_growth_plots(matrices)) write(name, plot);
  return EXIT_SUCCESS;
}

// 0 when the text is not a positive number.
int parsed_count(const std::string& text) {
  if (text.empty() || text.size() > 6 ||
      text.find_first_not_of("0123456789") != std::string::npos) {
    return 0;
  }
  return std::stoi(text);
}

}  // namespace

int main(int argc, char** argv) {
  const bool counted = argc == 4 && std::string(argv[2]) == "--matrices";
  const int matrices = counted ? parsed_count(argv[3]) : kDefaultMatrices;
  if ((argc != 2 && !counted) || matrices == 0) {
    std::cerr << "usage: isochor_thesis_figures OUTDIR [--matrices N]\n";
    return 2;
  }
  try {
    return run(argv[1], matrices);
  } catch (const std::exception& error) {
    std::cerr << "isochor_thesis_figures: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
