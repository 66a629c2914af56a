#include <cstdio>

int main() {
  std::puts("isochor 0.1.0");
  return 0;
}
