// Measures reading and analysing real files against OpenCASCADE's own reading of them, and the
// volume against OpenCASCADE's at 1e-9; prints Markdown tables.
//
// usage: isochor_import_performance FILE...
// Exit status: 0 measured, 2 usage, 3 a file cannot be read.
#include <sys/resource.h>

#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Reader.hxx>
#include <TopoDS_Shape.hxx>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "isochor/base/error.h"
#include "isochor/step/bridge.h"
#include "isochor/step/document.h"
#include "isochor/step/flux.h"
#include "isochor/step/solid_model.h"
#include "machine.h"
#include "timing.h"

namespace isochor::bench {
namespace {

constexpr double kEps = 1e-9;

// Each program is run in turn, so that what else the machine does meets all of them alike, and the
// least time counts.
constexpr int kLeastRounds = 15;
constexpr int kMostRounds = 60;
constexpr double kLeastSeconds = 3.0;
constexpr int kVolumeRounds = 20;

// Processor time, user and system, of this process and of the children that ended.
double cpu_seconds() {
  double total = 0.0;
  for (const auto who : {RUSAGE_CHILDREN, RUSAGE_SELF}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& t : {usage.ru_utime, usage.ru_stime}) {
      total += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    }
  }
  return total;
}

// The least processor time of each of `works`, which read in a child process, as if for the first
// time. What this process does to start it and to take its result counts, too.
std::vector<double> best_cpu_seconds_of(const std::vector<std::function<void()>>& works) {
  std::vector<double> best(works.size(), std::numeric_limits<double>::infinity());
  const double start = cpu_seconds();
  for (int k = 0; k < kLeastRounds || (k < kMostRounds && cpu_seconds() - start < kLeastSeconds);
       ++k) {
    for (size_t w = 0; w < works.size(); ++w) {
      const double begin = cpu_seconds();
      works[w]();
      best[w] = std::min(best[w], cpu_seconds() - begin);
    }
  }
  return best;
}

template <typename Reader>
void transfer_with_occt(const std::string& path) {
  // Never taken apart, as in our own children: they end without destructors.
  auto* const reader = new Reader;
  reader->ReadFile(path.c_str());
  reader->TransferRoots();
  if (reader->OneShape().IsNull()) throw InputError(path, "", "has no shape");
}

// The shortest program that gets a shape out of the file: no names, no colours, no checks.
void read_with_occt(const std::string& path) {
  switch (internal::format_of(path)) {
    case internal::FileFormat::kStep:
      transfer_with_occt<STEPControl_Reader>(path);
      return;
    case internal::FileFormat::kIges:
      transfer_with_occt<IGESControl_Reader>(path);
      return;
    case internal::FileFormat::kBrep: {
      auto* const shape = new TopoDS_Shape;
      if (!BRepTools::Read(*shape, path.c_str(), BRep_Builder())) {
        throw InputError(path, "", "has no shape");
      }
    }
  }
}

void print_import_row(const std::string& path) {
  SolidModel model;
  const auto in_child = [&](void (*work)(const std::string&)) {
    return [&path, work] {
      run_in_child(path, [&] {
        work(path);
        return std::string();
      });
    };
  };
  const std::vector<double> best = best_cpu_seconds_of(
      {in_child(read_with_occt), in_child([](const std::string& of) {
         new internal::Document(internal::load_document(of));  // ends with the child
       }),
       [&] { model = read_solid(path); }});
  std::printf("| %s | %zu | %.1f | %.1f | %.1f | %.2f |\n",
              std::filesystem::path(path).filename().c_str(), model.faces.size(), 1e3 * best[0],
              1e3 * best[1], 1e3 * best[2], best[2] / best[0]);
  std::fflush(stdout);
}

void print_volume_row(const std::string& path) {
  const internal::Document document = internal::load_document(path);
  internal::ShapeIntegrals integrals;
  GProp_GProps properties;
  double reached = 0.0;
  double ours = std::numeric_limits<double>::infinity();
  double occt = ours;
  for (int k = 0; k < kVolumeRounds; ++k) {
    const auto once = [](const auto& work) {
      return best_seconds(CLOCK_PROCESS_CPUTIME_ID, work, {1, 0.0});
    };
    ours = std::min(ours, once([&] { integrals = internal::integrate_shape(document.shape); }));
    occt = std::min(occt, once([&] {
                      properties = GProp_GProps();
                      reached = BRepGProp::VolumeProperties(document.shape, properties, kEps);
                    }));
  }
  std::printf("| %s | %.2f | %.1f | %.1f | %.17g | %.17g | %.1e |\n",
              std::filesystem::path(path).filename().c_str(), 1e3 * ours, 1e3 * occt, occt / ours,
              integrals.volume, properties.Mass(), reached);
  std::fflush(stdout);
}

int run(const std::vector<std::string>& paths) {
  Message::DefaultMessenger()->ChangePrinters().Clear();  // its readers talk
  std::printf("Machine: %s. Load average: %s.\nCompiler: %s.\n\n", processor_name().c_str(),
              load_average().c_str(), compiler_name().c_str());
  std::printf(
      "| file | faces | OpenCASCADE reads (ms) | with names, account (ms) | read and analysed "
      "(ms) | ratio |\n|---|---|---|---|---|---|\n");
  for (const auto& path : paths) print_import_row(path);
  std::printf(
      "\n| file | volume (ms) | OpenCASCADE, 1e-9 (ms) | ratio | volume | OpenCASCADE's | error it "
      "states |\n|---|---|---|---|---|---|---|\n");
  for (const auto& path : paths) print_volume_row(path);
  return 0;
}

}  // namespace
}  // namespace isochor::bench

int main(int count, char** arguments) {
  if (count < 2) {
    std::fputs("usage: isochor_import_performance FILE...\n", stderr);
    return 2;
  }
  try {
    return isochor::bench::run({arguments + 1, arguments + count});
  } catch (const isochor::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
}
