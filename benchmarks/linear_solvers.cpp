// One linear system of a Newton step of a scene by our conjugate gradients and by the direct solvers of Debian: how
// long each takes, and what it leaves. Needs the packages of [solvers] in packages.txt.
#include "selvage/core/error.h"
#include "selvage/scene/scene.h"
#include "simulation/implicit/implicit_step.h"
#include "simulation/newton/conjugate_gradients.h"

#include <cblas.h>
#include <dmumps_c.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>
#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>
#include <Eigen/SuperLUSupport>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>

/// Of OpenMP's library: its header is not there for every compiler.
extern "C" void omp_set_num_threads(int count);

namespace selvage {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

struct System {
  BlockMatrix blocks;
  Matrix matrix;  ///< all of it
  Eigen::VectorXd right;
};

Matrix expand(const BlockMatrix& blocks) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index row = 0; row < blocks.row_count(); ++row)
    for (std::int64_t i = blocks.first[row]; i < blocks.first[row + 1]; ++i)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
          entries.emplace_back(3 * row + k, 3 * blocks.columns[i] + l, blocks.blocks[i](k, l));
  Matrix matrix(3 * blocks.row_count(), 3 * blocks.row_count());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// The first system of the step after so many frames. All have contacts, and no step is halved.
System system_of(const Scene& scene, int frames) {
  NewtonOptions options = scene.newton;
  static_cast<StepOptions&>(options) = scene.options;
  State state = scene.initial_state;
  {
    NewtonSolver solver(scene.model, state, scene.handles, scene.colliders, options);
    for (int step = 0; step < frames * scene.substeps; ++step) solver.step(state);
  }
  System system;
  ImplicitStep last(scene.model, state, scene.handles, scene.colliders, options);
  last.step(state, {}, [&](IncrementalPotential& potential, bool, std::vector<Vec3>& x) {
    if (system.right.size() > 0) return;
    potential.renew_friction(x, true);
    potential.assemble(x, false, system.right, system.blocks);
    system.right = -system.right;
  });
  if (system.right.size() == 0) throw Error("scene", "all bodies sleep after these frames", "take fewer frames");
  system.matrix = expand(system.blocks);
  return system;
}

/// Seconds of the parts of a solution; 0: the solver has no such part.
struct Times {
  double order = 0, factorize = 0, solve = 0;
};

struct Solution {
  Times times;
  std::int64_t iterations = 0;  ///< 0: solved directly
  Eigen::VectorXd x;
};

template <typename Do>
double seconds_of(Do&& act) {
  const auto begin = std::chrono::steady_clock::now();
  act();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Solution by_gradients(const System& system, double tolerance) {
  Solution solution;
  ConjugateGradients gradients;
  const auto solve = [&] { solution.iterations = gradients.solve(system.blocks, system.right, tolerance, solution.x); };
  solution.times.solve = seconds_of(solve);
  return solution;
}

void check_factor(bool is_good) {
  if (!is_good) throw Error("matrix", "cannot be factorized", "it may not be positive definite");
}

template <typename Solver>
Solution by_cholesky(const System& system) {
  const Matrix lower = system.matrix.triangularView<Eigen::Lower>();
  Solver solver;
  Solution solution;
  solution.times.order = seconds_of([&] { solver.analyzePattern(lower); });
  solution.times.factorize = seconds_of([&] { solver.factorize(lower); });
  check_factor(solver.info() == Eigen::Success);
  solution.times.solve = seconds_of([&] { solution.x = solver.solve(system.right); });
  return solution;
}

/// Pivots on the diagonal, as for matrices that are nearly symmetric. It orders as it factorizes.
Solution by_super_lu(const System& system) {
  Eigen::SuperLU<Matrix> solver;
  solver.options().SymmetricMode = YES;
  solver.options().ColPerm = MMD_AT_PLUS_A;
  solver.options().DiagPivotThresh = 0.001;
  solver.options().IterRefine = NOREFINE;
  Solution solution;
  solution.times.factorize = seconds_of([&] { solver.compute(system.matrix); });
  check_factor(solver.info() == Eigen::Success);
  solution.times.solve = seconds_of([&] { solution.x = solver.solve(system.right); });
  return solution;
}

Solution by_mumps(const System& system) {
  constexpr int kNoFortranCommunicator = -987654;
  std::vector<int> rows, columns;
  std::vector<double> values;
  for (int column = 0; column < system.matrix.outerSize(); ++column)
    for (Matrix::InnerIterator entry(system.matrix, column); entry; ++entry) {
      if (entry.row() < column) continue;
      rows.push_back(static_cast<int>(entry.row()) + 1);
      columns.push_back(column + 1);
      values.push_back(entry.value());
    }
  Solution solution;
  solution.x = system.right;
  DMUMPS_STRUC_C mumps{};
  const auto run = [&mumps](int job) {
    mumps.job = job;
    dmumps_c(&mumps);
  };
  mumps.sym = 1;  // positive definite
  mumps.par = 1;
  mumps.comm_fortran = kNoFortranCommunicator;
  run(-1);
  for (int i = 0; i < 4; ++i) mumps.icntl[i] = i < 3 ? -1 : 0;  // no messages
  mumps.n = static_cast<int>(system.matrix.rows());
  mumps.nnz = static_cast<MUMPS_INT8>(values.size());
  mumps.irn = rows.data();
  mumps.jcn = columns.data();
  mumps.a = values.data();
  mumps.rhs = solution.x.data();
  solution.times = {seconds_of([&] { run(1); }), seconds_of([&] { run(2); }), seconds_of([&] { run(3); })};
  const bool is_good = mumps.infog[0] >= 0;
  run(-2);
  check_factor(is_good);
  return solution;
}

struct Row {
  const char *name, *licence;
  double most_left;  ///< by the length of the right side: more is an error
  std::function<Solution(const System&)> solve;
};

std::vector<Row> rows() {
  using Eigen::Lower;
  constexpr double kDirect = 1e-8, kRoom = 1.01;
  const auto by_gradients_to = [](double tolerance) {
    return [tolerance](const System& system) { return by_gradients(system, tolerance); };
  };
  return {
      {"conjugate gradients, to 1e-3", "ours", kRoom * 1e-3, by_gradients_to(1e-3)},
      {"conjugate gradients, to 1e-6", "ours", kRoom * 1e-6, by_gradients_to(1e-6)},
      {"Eigen `SimplicialLLT`, AMD", "MPL2", kDirect, by_cholesky<Eigen::SimplicialLLT<Matrix, Lower>>},
      {"Eigen `SimplicialLDLT`, AMD", "MPL2", kDirect, by_cholesky<Eigen::SimplicialLDLT<Matrix, Lower>>},
      {"CHOLMOD simplicial", "LGPL", kDirect, by_cholesky<Eigen::CholmodSimplicialLLT<Matrix, Lower>>},
      {"CHOLMOD supernodal", "GPL", kDirect, by_cholesky<Eigen::CholmodSupernodalLLT<Matrix, Lower>>},
      {"SuperLU, symmetric mode", "BSD", kDirect, by_super_lu},
      {"MUMPS, sequential", "CeCILL-C", kDirect, by_mumps},
  };
}

/// @return milliseconds; empty where there are none
std::string median(const std::vector<Solution>& solutions, double Times::*part) {
  std::vector<double> seconds(solutions.size());
  std::transform(solutions.begin(), solutions.end(), seconds.begin(),
                 [part](const Solution& solution) { return solution.times.*part; });
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  return *middle > 0 ? fmt::format("{:.1f}", 1e3 * *middle) : "";
}

void print_table(const System& system, int repetitions) {
  fmt::print(
      "| solver | licence | iterations | order [ms] | factorise [ms] | solve [ms] | residual by right side |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Row& row : rows()) {
    std::vector<Solution> solutions(static_cast<std::size_t>(repetitions));
    for (Solution& solution : solutions) solution = row.solve(system);
    const Solution& last = solutions.back();
    const double left = (system.right - system.matrix * last.x).norm() / system.right.norm();
    fmt::print("| {} | {} | {} | {} | {} | {} | {:.1e} |\n", row.name, row.licence,
               last.iterations > 0 ? std::to_string(last.iterations) : "", median(solutions, &Times::order),
               median(solutions, &Times::factorize), median(solutions, &Times::solve), left);
    std::fflush(stdout);
    if (!(left <= row.most_left))
      throw Error(row.name, fmt::format("leaves {:.2g} of the right side", left),
                  fmt::format("at most {:.2g} is right", row.most_left));
  }
}

Scene read_newton_scene(const std::filesystem::path& file, const std::vector<std::string>& settings) {
  Scene scene = read_scene(file, {}, settings);
  if (scene.solver != SolverKind::kNewton)
    throw Error(file.string(), "its solver has no linear systems", R"(give --set '/solver="newton"')");
  return scene;
}

int run(int count, char** arguments) {
  CLI::App app(
      "One linear system of a Newton step by each solver, one thread: a table in Markdown.\n"
      "Exit status: 0 done, 1 a residual is too large or the scene is amiss, 2 an option is.");
  app.footer("Example: linear_solvers scenes/octopi_6_implicit.json --frames 57");
  std::filesystem::path file;
  std::vector<std::string> settings;
  int frames = 0, repetitions = 5;
  app.add_option("scene", file, "A scene file whose solver is newton")->required()->check(CLI::ExistingFile);
  app.add_option("--frames", frames, "Frames before the step whose first system is taken")
      ->check(CLI::Range(0, 100'000));
  app.add_option("--set", settings, "A value in place of the scene's, as in selvage simulate");
  app.add_option("--repetitions", repetitions, "Times that each solver runs: medians are shown")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  app.failure_message(
      [](const CLI::App*, const CLI::Error& error) { return fmt::format("linear_solvers: {}\n", error.what()); });
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  openblas_set_num_threads(1);
  omp_set_num_threads(1);                   // CHOLMOD
  setenv("SCOTCH_PTHREAD_NUMBER", "1", 1);  // which orders for MUMPS
  const Scene scene = read_newton_scene(file, settings);
  const System system = system_of(scene, frames);
  fmt::print("{}, the step after frame {}: {} unknowns, {} numbers in the matrix; one thread, {}\n\n", scene.name,
             frames, system.matrix.rows(), system.matrix.nonZeros(), openblas_get_config());
  std::fflush(stdout);
  print_table(system, repetitions);
  return 0;
}

}  // namespace
}  // namespace selvage

int main(int count, char** arguments) {
  try {
    return selvage::run(count, arguments);
  } catch (const selvage::Error& error) {
    fmt::print(stderr, "linear_solvers: {}\n", error.what());
    return 1;
  }
}
