#include "isochor/step/bytes.h"

namespace isochor::internal {

void ByteReader::raw(void* data, size_t size) {
  if (size > left()) throw BytesError("the bytes of a result end too early");
  if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
  at_ += size;
}

}  // namespace isochor::internal
