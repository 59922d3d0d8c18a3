// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/solve/bundle_schur.h"

#include <Eigen/Cholesky>
#include <Eigen/CholmodSupport>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "server/solve/reprojection.h"

namespace coslam {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;
using Sparse = Eigen::SparseMatrix<double>;

struct Estimate {
  std::vector<Rigid3> poses;
  std::vector<Eigen::Matrix3d> rotations;  // of the poses
  std::vector<Eigen::Vector3d> points;
  std::vector<LensCorrection> lenses;  // by camera, or none
};

// One pose or half of a lens that is free and one point that is seen from or through it.
struct Link {
  int column;  // among those that are free: poses, then lenses, two each
  int point;
};
constexpr int kHalves = LensCorrection::kTerms / 6;  // of a lens, each as large as a pose

// What does not change while it is solved: who sees what.
struct Structure {
  std::vector<int> column_of;           // of each pose among the free ones; -1: fixed
  std::vector<int> lens_column_of;      // first one of each camera; -1: its lens is given
  int columns = 0;                      // of free poses and lenses
  std::vector<Eigen::Matrix2d> whiten;  // of each observation, from undistorted px to standard deviations
  std::vector<Eigen::Vector2d> raw_px;  // the same observation in the raw image, where there are lenses
  std::vector<int> link_of;             // of each observation; -1: its pose is fixed
  std::array<std::vector<int>, kHalves> lens_link_of;  // the same of its camera's lens
  std::vector<Link> links;                             // ascending points, then columns
  std::vector<int> links_end;                          // one beyond the last link of each point
  std::vector<std::vector<int>> links_at;              // of each column
  std::vector<std::vector<int>> rows_at;  // of each column: those of its blocks that are not empty, the diagonal first
};

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Which links there are, and which of them each observation is part of.
void link_observations(const BundleProblem& problem, Structure* s) {
  const std::size_t n = problem.observations.size();
  struct Part {
    int point, column;
    std::size_t observation;
    std::vector<int>* link_of;
  };
  std::vector<Part> parts;
  parts.reserve(problem.lenses.empty() ? n : (1 + kHalves) * n);
  s->link_of.resize(n, -1);
  for (auto& of_half : s->lens_link_of) of_half.resize(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& o = problem.observations[i];
    const int column = s->column_of[at(o.pose)];
    const int lens = s->lens_column_of[at(problem.poses[at(o.pose)].camera)];
    if (column >= 0) parts.push_back({o.point, column, i, &s->link_of});
    for (int half = 0; lens >= 0 && half < kHalves; ++half) {
      parts.push_back({o.point, lens + half, i, &s->lens_link_of[at(half)]});
    }
  }
  std::ranges::stable_sort(parts, {}, [](const Part& p) { return std::pair(p.point, p.column); });
  s->links_end.resize(problem.points.size());
  for (const Part& p : parts) {
    const bool again = !s->links.empty() && s->links.back().point == p.point && s->links.back().column == p.column;
    if (!again) s->links.push_back({p.column, p.point});
    (*p.link_of)[p.observation] = static_cast<int>(s->links.size()) - 1;
    s->links_end[at(p.point)] = static_cast<int>(s->links.size());
  }
}

Structure structure_of(const BundleProblem& problem) {
  Structure s;
  for (const auto& p : problem.poses) s.column_of.push_back(p.fixed ? -1 : s.columns++);
  s.lens_column_of.resize(problem.cameras.size(), -1);
  for (std::size_t i = 0; i < problem.lenses.size(); ++i) {
    if (problem.lenses[i].free) s.lens_column_of[i] = std::exchange(s.columns, s.columns + kHalves);
  }
  link_observations(problem, &s);
  for (std::size_t p = 1; p < s.links_end.size(); ++p) s.links_end[p] = std::max(s.links_end[p], s.links_end[p - 1]);
  s.links_at.resize(at(s.columns));
  for (std::size_t l = 0; l < s.links.size(); ++l) s.links_at[at(s.links[l].column)].push_back(static_cast<int>(l));

  s.rows_at.resize(at(s.columns));
  for (const auto& t : problem.ties) {
    const auto [low, high] = std::minmax(s.column_of[at(t.first)], s.column_of[at(t.second)]);
    if (low >= 0 && low != high) s.rows_at[at(low)].push_back(high);
  }
  std::vector<int> last_at(at(s.columns), -1);  // column at which a row was noted last
  for (int c = 0; c < s.columns; ++c) {
    auto& rows = s.rows_at[at(c)];
    std::vector<int> tied = std::exchange(rows, {c});
    last_at[at(c)] = c;
    const auto note = [&](int row) {
      if (std::exchange(last_at[at(row)], c) != c) rows.push_back(row);
    };
    for (const int row : tied) note(row);
    for (const int l : s.links_at[at(c)]) {
      for (int k = l + 1; k < s.links_end[at(s.links[at(l)].point)]; ++k) note(s.links[at(k)].column);
    }
    std::sort(rows.begin(), rows.end());
  }
  for (const auto& o : problem.observations) {
    const CameraModel& camera = problem.cameras[at(problem.poses[at(o.pose)].camera)];
    if (problem.lenses.empty()) {
      s.whiten.emplace_back(camera.raw_by_undistorted(o.undistorted_px) / o.sigma_px);
    } else {
      s.raw_px.push_back(camera.raw_from_undistorted(o.undistorted_px));
    }
  }
  return s;
}

// Cauchy's loss, or squares.
class Loss {
 public:
  explicit Loss(double sigmas) : c2_(sigmas * sigmas) {}
  double value(double d2) const { return c2_ > 0 ? c2_ * std::log1p(d2 / c2_) : d2; }
  double slope(double d2) const { return c2_ > 0 ? 1 / (1 + d2 / c2_) : 1; }

 private:
  double c2_;
};

// What the calibration says of a lens: its part of the cost (twice), of the diagonal and of the gradient.
struct LensPriorTerm {
  double cost = 0;
  LensCorrection::Values weights, gradient;
};

LensPriorTerm lens_prior(const BundleProblem::Lens& lens, const LensCorrection& now) {
  constexpr double kTailSigmas = 3;
  const Loss loss(kTailSigmas);
  LensPriorTerm out;
  for (int i = 0; i < LensCorrection::kTerms; ++i) {
    const double weight = 1 / (lens.prior_sigma[i] * lens.prior_sigma[i]), d2 = weight * now.values[i] * now.values[i];
    out.cost += loss.value(d2);
    out.weights[i] = loss.slope(d2) * weight;
    out.gradient[i] = out.weights[i] * now.values[i];
  }
  return out;
}

double cost_of(const BundleProblem& problem, const Structure& s, const Loss& loss, const Estimate& e) {
  double cost = 0;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const CameraModel& camera = problem.cameras[at(problem.poses[at(o.pose)].camera)];
    const Eigen::Vector3d x = e.rotations[at(o.pose)] * e.points[at(o.point)] + e.poses[at(o.pose)].translation;
    const Eigen::Vector2d residual =
        problem.lenses.empty() ? reprojection_residual(camera, s.whiten[i], o.undistorted_px, x)
                               : lens_reprojection_residual(camera, e.lenses[at(problem.poses[at(o.pose)].camera)],
                                                            s.raw_px[i], o.sigma_px, x);
    cost += o.weight * loss.value(residual.squaredNorm());
  }
  for (std::size_t i = 0; i < problem.lenses.size(); ++i) {
    if (problem.lenses[i].free) cost += lens_prior(problem.lenses[i], e.lenses[i]).cost;
  }
  for (const auto& t : problem.ties) {
    cost += tie(t.second_from_first, e.poses[at(t.first)], e.poses[at(t.second)]).residual.squaredNorm();
  }
  return 0.5 * cost;
}

// Normal equations around an estimate, without damping.
struct System {
  std::vector<Matrix6d> columns;  // diagonal blocks, of free poses and lenses
  std::vector<Vector6d> column_gradients;
  std::vector<Eigen::Matrix3d> points;
  std::vector<Eigen::Vector3d> point_gradients;
  std::vector<Matrix63> links;
  std::vector<std::pair<std::pair<int, int>, Matrix6d>> ties;  // (row, column) of the lower half
};

System build(const BundleProblem& problem, const Structure& s, const Loss& loss, const Estimate& e) {
  System out{std::vector<Matrix6d>(at(s.columns), Matrix6d::Zero()),
             std::vector<Vector6d>(at(s.columns), Vector6d::Zero()),
             std::vector<Eigen::Matrix3d>(e.points.size(), Eigen::Matrix3d::Zero()),
             std::vector<Eigen::Vector3d>(e.points.size(), Eigen::Vector3d::Zero()),
             std::vector<Matrix63>(s.links.size(), Matrix63::Zero()),
             {}};
  // What each free pose and the lens of its camera have in common, and the two halves of a lens.
  using Halves = std::array<Matrix6d, kHalves>;
  std::vector<Halves> shared(problem.lenses.empty() ? 0 : problem.poses.size(), {Matrix6d::Zero(), Matrix6d::Zero()});
  std::vector<Matrix6d> between(problem.lenses.size(), Matrix6d::Zero());
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const auto& o = problem.observations[i];
    const CameraModel& camera = problem.cameras[at(problem.poses[at(o.pose)].camera)];
    const auto of = at(problem.poses[at(o.pose)].camera);
    Eigen::Matrix<double, 2, LensCorrection::kTerms> by_lens;
    const Reprojection r =
        problem.lenses.empty()
            ? reprojection(camera, s.whiten[i], o.undistorted_px, e.rotations[at(o.pose)],
                           e.poses[at(o.pose)].translation, e.points[at(o.point)])
            : lens_reprojection(camera, e.lenses[of], s.raw_px[i], o.sigma_px, e.rotations[at(o.pose)],
                                e.poses[at(o.pose)].translation, e.points[at(o.point)], &by_lens);
    const double weight = o.weight * loss.slope(r.residual.squaredNorm());
    const Eigen::Matrix<double, 3, 2> by_point = weight * r.by_point.transpose();
    out.points[at(o.point)].noalias() += by_point.lazyProduct(r.by_point);
    out.point_gradients[at(o.point)].noalias() += by_point.lazyProduct(r.residual);
    const auto add = [&](int column, int link, const Eigen::Matrix<double, 2, 6>& by) {
      const Eigen::Matrix<double, 6, 2> weighted = weight * by.transpose();
      out.columns[at(column)].noalias() += weighted.lazyProduct(by);
      out.column_gradients[at(column)].noalias() += weighted.lazyProduct(r.residual);
      out.links[at(link)].noalias() += weighted.lazyProduct(r.by_point);
    };
    if (s.link_of[i] >= 0) add(s.column_of[at(o.pose)], s.link_of[i], r.by_pose);
    if (s.lens_column_of[of] < 0) continue;
    for (int half = 0; half < kHalves; ++half) {
      const Eigen::Matrix<double, 2, 6> by_half = by_lens.middleCols<6>(6 * half);
      add(s.lens_column_of[of] + half, s.lens_link_of[at(half)][i], by_half);
      if (s.link_of[i] >= 0) shared[at(o.pose)][at(half)].noalias() += weight * by_half.transpose() * r.by_pose;
    }
    between[of].noalias() += weight * by_lens.rightCols<6>().transpose() * by_lens.leftCols<6>();
  }
  for (std::size_t pose = 0; pose < shared.size(); ++pose) {
    const int column = s.column_of[pose], lens = s.lens_column_of[at(problem.poses[pose].camera)];
    if (column < 0 || lens < 0 || s.links_at[at(column)].empty()) continue;
    for (int half = 0; half < kHalves; ++half) {
      out.ties.emplace_back(std::pair(lens + half, column), shared[pose][at(half)]);
    }
  }
  for (std::size_t i = 0; i < problem.lenses.size(); ++i) {
    const int column = s.lens_column_of[i];
    if (column < 0) continue;
    const LensPriorTerm prior = lens_prior(problem.lenses[i], e.lenses[i]);
    for (int half = 0; half < kHalves; ++half) {
      out.columns[at(column + half)].diagonal() += prior.weights.segment<6>(6 * half);
      out.column_gradients[at(column + half)] += prior.gradient.segment<6>(6 * half);
    }
    if (!s.links_at[at(column)].empty()) out.ties.emplace_back(std::pair(column + 1, column), between[i]);
  }
  for (const auto& t : problem.ties) {
    const Tie is = tie(t.second_from_first, e.poses[at(t.first)], e.poses[at(t.second)]);
    const int first = s.column_of[at(t.first)], second = s.column_of[at(t.second)];
    const auto add = [&](int column, const Matrix6d& by) {
      if (column < 0) return;
      out.columns[at(column)] += by.transpose() * by;
      out.column_gradients[at(column)] += by.transpose() * is.residual;
    };
    add(first, is.by_first);
    add(second, is.by_second);
    if (first < 0 || second < 0 || first == second) continue;
    const Matrix6d block = is.by_second.transpose() * is.by_first;
    out.ties.emplace_back(std::pair(std::max(first, second), std::min(first, second)),
                          second > first ? block : Matrix6d(block.transpose()));
  }
  return out;
}

// What is added to a diagonal: a share of itself.
template <class Block>
auto damping(const Block& block, double radius) {
  constexpr double kLeast = 1e-6;
  return (block.diagonal().array().max(kLeast) / radius).matrix().eval();
}

// The lower half of the reduced system of the poses and lenses, by its blocks.
class Reduced {
 public:
  explicit Reduced(const Structure& s) : s_(s), slot_(at(s.columns)) {
    first_.reserve(at(s.columns) + 1);
    std::size_t n = 0;
    for (const auto& rows : s.rows_at) {
      first_.push_back(n);
      n += rows.size();
    }
    first_.push_back(n);
    blocks_.resize(n);
  }

  // links_by_points: H_cp H_pp^-1.
  void fill(const System& system, double radius, const std::vector<Matrix63>& links_by_points) {
    for (int c = 0; c < s_.columns; ++c) {
      const auto& rows = s_.rows_at[at(c)];
      Matrix6d* const blocks = blocks_.data() + first_[at(c)];
      for (std::size_t k = 0; k < rows.size(); ++k) {
        blocks[k].setZero();
        slot_[at(rows[k])] = k;
      }
      blocks[0] = system.columns[at(c)];
      blocks[0].diagonal() += damping(system.columns[at(c)], radius);
      for (const int l : s_.links_at[at(c)]) {
        const Eigen::Matrix<double, 3, 6> here = system.links[at(l)].transpose();
        for (int k = l; k < s_.links_end[at(s_.links[at(l)].point)]; ++k) {
          blocks[slot_[at(s_.links[at(k)].column)]].noalias() -= links_by_points[at(k)].lazyProduct(here);
        }
      }
    }
    for (const auto& [place, block] : system.ties) {
      const auto& rows = s_.rows_at[at(place.second)];
      const auto row = std::ranges::lower_bound(rows, place.first) - rows.begin();
      blocks_[first_[at(place.second)] + static_cast<std::size_t>(row)] += block;
    }
  }

  // x for *this x = b; empty when it is not positive definite.
  std::optional<Eigen::VectorXd> solve(const Eigen::VectorXd& b) {
    constexpr int kDenseMost = 120;
    return s_.columns <= kDenseMost ? solve_dense(b) : solve_sparse(b);
  }

 private:
  std::optional<Eigen::VectorXd> solve_dense(const Eigen::VectorXd& b) {
    dense_.setZero(b.size(), b.size());
    for (int c = 0; c < s_.columns; ++c) {
      const auto& rows = s_.rows_at[at(c)];
      for (std::size_t k = 0; k < rows.size(); ++k) {
        dense_.block<6, 6>(6 * rows[k], 6 * c) = blocks_[first_[at(c)] + k];
      }
    }
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
    if (factor.info() != Eigen::Success) return std::nullopt;
    return factor.solve(b);
  }

  std::optional<Eigen::VectorXd> solve_sparse(const Eigen::VectorXd& b) {
    const bool first_time = sparse_.nonZeros() == 0;
    if (first_time) make_pattern();
    double* value = sparse_.valuePtr();
    for (int c = 0; c < s_.columns; ++c) {
      const std::size_t blocks = s_.rows_at[at(c)].size();
      for (int j = 0; j < 6; ++j) {
        for (std::size_t k = 0; k < blocks; ++k, value += 6) {
          Eigen::Map<Vector6d>{value} = blocks_[first_[at(c)] + k].col(j);
        }
      }
    }
    if (first_time) {
      factor_.cholmod().print = 0;  // where it fails, the step is damped more
      // What cameras see of one place at different times lies far apart: cut into parts that share little (METIS) the
      // factor takes a fifth less work than by degree.
      factor_.cholmod().nmethods = 1;
      factor_.cholmod().method[0].ordering = CHOLMOD_METIS;
      factor_.analyzePattern(sparse_);
    }
    factor_.factorize(sparse_);
    if (factor_.info() != Eigen::Success) return std::nullopt;
    return factor_.solve(b);
  }

  // Whole blocks on the diagonal as well: what lies above it is not looked at.
  void make_pattern() {
    const auto size = static_cast<Eigen::Index>(6 * s_.columns);
    sparse_.resize(size, size);
    sparse_.resizeNonZeros(static_cast<Eigen::Index>(36 * blocks_.size()));
    int n = 0;
    for (int c = 0; c < s_.columns; ++c) {
      for (int j = 0; j < 6; ++j) {
        sparse_.outerIndexPtr()[6 * c + j] = n;
        for (const int row : s_.rows_at[at(c)]) {
          for (int i = 0; i < 6; ++i) sparse_.innerIndexPtr()[n++] = 6 * row + i;
        }
      }
    }
    sparse_.outerIndexPtr()[size] = n;
  }

  const Structure& s_;
  std::vector<std::size_t> first_;  // block of each column, and one beyond the last
  std::vector<Matrix6d> blocks_;
  std::vector<std::size_t> slot_;  // of a row among those of the column in work
  Eigen::MatrixXd dense_;
  Sparse sparse_;
  Eigen::CholmodDecomposition<Sparse, Eigen::Lower> factor_;
};

struct Step {
  Eigen::VectorXd columns;
  std::vector<Eigen::Vector3d> points;
  double decrease = 0;  // of the cost that the system promises
};

// The points, damped, so that they can be left out of the system.
struct Eliminated {
  std::vector<Eigen::Vector3d> dampings;
  std::vector<Eigen::Matrix3d> inverse;
  std::vector<Matrix63> by_points;  // H_cp H_pp^-1 of each link
};

Eliminated eliminate(const Structure& s, const System& system, double radius) {
  Eliminated out;
  out.inverse.reserve(system.points.size());
  out.dampings.reserve(system.points.size());
  for (const Eigen::Matrix3d& own : system.points) {
    out.dampings.emplace_back(damping(own, radius));
    Eigen::Matrix3d damped = own;
    damped.diagonal() += out.dampings.back();
    out.inverse.emplace_back(damped.inverse());
  }
  out.by_points.resize(s.links.size());
  for (std::size_t l = 0; l < s.links.size(); ++l) {
    out.by_points[l].noalias() = system.links[l].lazyProduct(out.inverse[at(s.links[l].point)]);
  }
  return out;
}

std::optional<Step> solve(const Structure& s, const System& system, double radius, Reduced* reduced) {
  const auto [dampings, inverse, by_points] = eliminate(s, system, radius);
  Eigen::VectorXd right(6 * s.columns);
  for (int c = 0; c < s.columns; ++c) right.segment<6>(6 * c) = -system.column_gradients[at(c)];
  for (std::size_t l = 0; l < s.links.size(); ++l) {
    const auto point = at(s.links[l].point);
    right.segment<6>(6 * s.links[l].column).noalias() += by_points[l].lazyProduct(system.point_gradients[point]);
  }
  Step step;
  if (s.columns > 0) {
    reduced->fill(system, radius, by_points);
    auto columns = reduced->solve(right);
    if (!columns) return std::nullopt;
    step.columns = std::move(*columns);
  }
  step.points.resize(system.points.size());
  for (std::size_t p = 0; p < step.points.size(); ++p) step.points[p] = -inverse[p] * system.point_gradients[p];
  for (std::size_t l = 0; l < s.links.size(); ++l) {
    step.points[at(s.links[l].point)].noalias() -=
        by_points[l].transpose().lazyProduct(step.columns.segment<6>(6 * s.links[l].column));
  }
  // -g d - d H d / 2, where (H + D) d = -g.
  for (int c = 0; c < s.columns; ++c) {
    const Vector6d d = step.columns.segment<6>(6 * c);
    step.decrease +=
        0.5 * d.dot(damping(system.columns[at(c)], radius).cwiseProduct(d) - system.column_gradients[at(c)]);
  }
  for (std::size_t p = 0; p < step.points.size(); ++p) {
    const Eigen::Vector3d& d = step.points[p];
    step.decrease += 0.5 * d.dot(dampings[p].cwiseProduct(d) - system.point_gradients[p]);
  }
  const bool finite = std::isfinite(step.decrease) && step.columns.allFinite();
  return finite ? std::optional(std::move(step)) : std::nullopt;
}

Estimate moved(const Structure& s, const Estimate& from, const Step& step) {
  Estimate e = from;
  for (std::size_t i = 0; i < e.poses.size(); ++i) {
    const int column = s.column_of[i];
    if (column < 0) continue;
    e.poses[i] = retract(e.poses[i], step.columns.segment<6>(6 * column));
    e.poses[i].rotation.normalize();
    e.rotations[i] = e.poses[i].rotation.toRotationMatrix();
  }
  for (std::size_t p = 0; p < e.points.size(); ++p) e.points[p] += step.points[p];
  for (std::size_t i = 0; i < e.lenses.size(); ++i) {
    const int column = s.lens_column_of[i];
    if (column >= 0) e.lenses[i].values += step.columns.segment<LensCorrection::kTerms>(6 * column);
  }
  return e;
}

Estimate start_of(const BundleProblem& problem) {
  Estimate e;
  for (const auto& p : problem.poses) {
    e.poses.push_back(p.cam_from_world);
    if (!p.fixed) e.poses.back().rotation.normalize();
    e.rotations.emplace_back(e.poses.back().rotation.toRotationMatrix());
  }
  e.points = problem.points;
  for (const auto& lens : problem.lenses) e.lenses.push_back(lens.start);
  return e;
}

// Of each free lens, by what all observations say together; empty where it cannot be told.
std::vector<LensMatrix> lens_covariances(const Structure& s, const System& system, Reduced* reduced) {
  constexpr double kHardlyDamped = 1e9;  // what nothing holds, as the scale, has no part in a lens
  const Eliminated points = eliminate(s, system, kHardlyDamped);
  reduced->fill(system, kHardlyDamped, points.by_points);
  std::vector<LensMatrix> out;
  for (const int column : s.lens_column_of) {
    out.emplace_back(LensMatrix::Zero());
    for (int k = 0; column >= 0 && k < LensCorrection::kTerms; ++k) {
      const auto solution = reduced->solve(Eigen::VectorXd::Unit(6 * s.columns, 6 * column + k));
      if (!solution) return {};
      out.back().col(k) = solution->segment<LensCorrection::kTerms>(6 * column);
    }
  }
  return out;
}

}  // namespace

BundleResult solve_by_schur(const BundleProblem& problem, const BundleConfig& config) {
  constexpr double kFirstRadius = 1e5, kLeastRadius = 1e-10, kMostRadius = 1e16, kLeastGain = 1e-3;
  const Structure s = structure_of(problem);
  const Loss loss(config.loss_sigmas);
  Estimate estimate = start_of(problem);
  Reduced reduced(s);
  BundleResult result;
  double cost = cost_of(problem, s, loss, estimate), radius = kFirstRadius, shrink = 2;
  result.initial_cost = cost;
  std::optional<System> system;
  bool done = false;
  while (!done && result.iterations < config.max_iterations && radius > kLeastRadius) {
    ++result.iterations;
    if (!system) system = build(problem, s, loss, estimate);
    if (const auto step = solve(s, *system, radius, &reduced)) {
      Estimate next = moved(s, estimate, *step);
      const double next_cost = cost_of(problem, s, loss, next);
      const double gain = step->decrease > 0 ? (cost - next_cost) / step->decrease : 0;
      done = std::abs(cost - next_cost) <= config.function_tolerance * cost;
      if (gain > kLeastGain) {
        estimate = std::move(next);
        cost = next_cost;
        system.reset();
        radius = std::min(kMostRadius, radius / std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3)));
        shrink = 2;
      } else {
        radius /= std::exchange(shrink, 2 * shrink);
      }
    } else {
      radius /= std::exchange(shrink, 2 * shrink);
    }
    if (config.after_iteration) config.after_iteration(result.iterations);
  }
  result.usable = std::isfinite(cost);
  result.final_cost = cost;
  if (!problem.lenses.empty() && s.columns > 0) {
    result.lens_covariances = lens_covariances(s, build(problem, s, loss, estimate), &reduced);
  }
  result.poses = std::move(estimate.poses);
  result.points = std::move(estimate.points);
  result.lenses = std::move(estimate.lenses);
  return result;
}

}  // namespace coslam
