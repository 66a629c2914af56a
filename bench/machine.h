// Facts about where a run took place, for the table's head.
#pragma once

#include <string>

namespace isochor::bench {

std::string processor_name();
std::string compiler_name();
std::string load_average();  // of one, five and fifteen minutes

}  // namespace isochor::bench
