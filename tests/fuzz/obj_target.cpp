// OBJ meshes: what is accepted can be drawn, and is written and read again without change.
#include "isochor/base/error.h"
#include "isochor/io/mesh_obj.h"
#include "target.h"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isochor::Mesh mesh;
  try {
    mesh = isochor::parse_obj(isochor::fuzz::text_of(data, size), "fuzz.obj");
  } catch (const isochor::InputError&) {
    return 0;
  }
  ++isochor::fuzz::accepted;
  isochor::require_usable(mesh);
  const std::string once = isochor::obj_text(mesh);
  const std::string twice = isochor::obj_text(isochor::parse_obj(once, "again.obj"));
  isochor::fuzz::promise(once == twice, "a mesh changes when it is written and read");
  return 0;
}
