// Benchmarks that are compared run by turns, several times: what else the computer does meanwhile
// falls on all of them.
#include <vector>

#include <benchmark/benchmark.h>

int main(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  // Before those of the command line, which win.
  char interleaving[] = "--benchmark_enable_random_interleaving=true";
  char repetitions[] = "--benchmark_repetitions=5";
  char aggregates[] = "--benchmark_display_aggregates_only=true";
  arguments.insert(arguments.begin() + 1, {interleaving, repetitions, aggregates});
  auto count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
