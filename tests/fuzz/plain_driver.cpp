// Runs a fuzz target without libFuzzer: over its seed files, then over seeded damage to them. The
// same inputs in every run.
//
// usage: TARGET --rounds N SEED_FILE...
#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <vector>

#include "target.h"

namespace {

using Random = std::mt19937_64;

size_t below(Random& random, size_t limit) { return random() % std::max<size_t>(1, limit); }

// Damage of the kinds that find most: bits, runs dropped or doubled, digits, and pieces of others.
void damage(std::string& text, const std::vector<std::string>& seeds, Random& random) {
  const size_t at = below(random, text.size());
  const size_t length = std::min(text.size() - at, 1 + below(random, 40));
  switch (below(random, 6)) {
    case 0:
      if (!text.empty()) text[at] = static_cast<char>(text[at] ^ (1 << below(random, 8)));
      break;
    case 1:
      text.erase(at, length);
      break;
    case 2:
      text.insert(at, text.substr(at, length));
      break;
    case 3: {
      static constexpr const char* kWords[] = {"0",  "-1",   "1e999", "NaN",        "null", "[]",
                                               "{}", "\"\"", "#1",    "2147483648", "'",    "\\"};
      const size_t digit = text.find_first_of("0123456789", at);
      const char* word = kWords[below(random, std::size(kWords))];
      if (digit != std::string::npos) text.replace(digit, 1, word);
      break;
    }
    case 4: {
      const std::string& other = seeds[below(random, seeds.size())];
      text.insert(at, other, below(random, other.size()), length);
      break;
    }
    default:
      text.resize(at);
  }
}

void run(const std::string& text) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4 || std::strcmp(argv[1], "--rounds") != 0) {
    std::fprintf(stderr, "usage: %s --rounds N SEED_FILE...\n", argv[0]);
    return 2;
  }
  const long rounds = std::atol(argv[2]);
  std::vector<std::string> seeds = {""};
  for (int k = 3; k < argc; ++k) {
    std::ifstream in(argv[k], std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || text.str().empty()) {
      std::fprintf(stderr, "%s: cannot be read\n", argv[k]);
      return 2;
    }
    seeds.push_back(text.str());
  }
  for (const std::string& seed : seeds) run(seed);
  isochor::fuzz::promise(isochor::fuzz::accepted > 0, "some seed is accepted");
  Random random(20061);
  for (long k = 0; k < rounds; ++k) {
    std::string text = seeds[below(random, seeds.size())];
    for (size_t times = 1 + below(random, 4); times > 0; --times) damage(text, seeds, random);
    run(text);
  }
  std::printf("%zu seeds and %ld damaged inputs, %ld of them accepted: no promise was broken\n",
              seeds.size(), rounds, isochor::fuzz::accepted);
  return 0;
}
