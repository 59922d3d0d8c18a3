// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/window.h"

#include "common/geometry/levenberg_marquardt.h"
#include "common/geometry/robust.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace coslam {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

// Sum of Cauchy's loss. A logarithm of many factors costs what one of a single factor does.
class CauchySum {
 public:
  void add(double d2) {
    constexpr double kMost = 1e200;
    factors_ *= 1 + d2 / (kCauchySigmas * kCauchySigmas);
    if (factors_ > kMost) {
      sum_ += std::log(factors_);
      factors_ = 1;
    }
  }
  double value() const { return kCauchySigmas * kCauchySigmas * (sum_ + std::log(factors_)); }

 private:
  double factors_ = 1, sum_ = 0;
};

double cauchy_weight(double d2) { return 1 / (1 + d2 / (kCauchySigmas * kCauchySigmas)); }

// What does not change while it is solved.
struct Observation {
  int pose;
  int column;  // of the pose among the free ones; -1: not free
  Eigen::Vector2d px;
  Eigen::Matrix2d whiten;  // from undistorted px to standard deviations
};

struct WindowState {
  std::vector<Rigid3> poses;
  std::vector<Eigen::Vector3d> things;
};

struct Coupling {
  int column;
  Matrix63 block;
};

struct WindowSystem {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  std::vector<Eigen::Matrix3d> thing_blocks;  // of things
  std::vector<Eigen::Vector3d> right;         // likewise
  std::vector<std::vector<Coupling>> coupling;
  double cost = 0;
};

struct Residual {
  Eigen::Vector2d r;
  Eigen::Matrix<double, 2, 6> by_pose;
  Eigen::Matrix<double, 2, 3> by_thing;
};

class Solver {
 public:
  explicit Solver(const WindowProblem& problem) : problem_(problem) {
    std::vector<int> columns;
    for (const bool free : problem.is_free) columns.push_back(free ? free_++ : -1);
    for (const WindowThing& thing : problem.things) {
      world_from_frame_.push_back(thing.frame_from_world.inverse());
      auto& of_thing = seen_.emplace_back();
      for (const auto& [pose, px] : thing.seen) {
        of_thing.push_back({pose, columns[static_cast<std::size_t>(pose)], px,
                            problem.camera->raw_by_undistorted(px) / problem.sigma_px});
      }
    }
  }

  WindowState start() const {
    WindowState state{problem_.cam_from_world, {}};
    for (const WindowThing& thing : problem_.things) state.things.push_back(thing.theta);
    return state;
  }

  WindowSystem build(const WindowState& state) const {
    const Eigen::Index n = 6 * free_;
    WindowSystem s{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), {}, {}, {}, 0};
    for (std::size_t i = 0; i < state.things.size(); ++i) {
      const WindowThing& thing = problem_.things[i];
      s.thing_blocks.push_back(thing.information);
      s.right.emplace_back(thing.information * (thing.prior - state.things[i]));
      s.coupling.emplace_back().reserve(seen_[i].size());
      s.cost += prior_cost(i, state.things[i]);
    }
    CauchySum loss;
    for_each(state, [&](std::size_t i, const Observation* o, const Residual& e, double d2) {
      loss.add(d2);
      if (o == nullptr) return;
      const double w = cauchy_weight(d2);
      s.thing_blocks[i] += w * e.by_thing.transpose() * e.by_thing;
      s.right[i] += w * e.by_thing.transpose() * e.r;
      if (o->column < 0) return;
      const Eigen::Matrix<double, 6, 2> jw = w * e.by_pose.transpose();
      const Eigen::Index at = 6 * o->column;
      s.a.block<6, 6>(at, at) += jw * e.by_pose;
      s.b.segment<6>(at) += jw * e.r;
      s.coupling[i].push_back({o->column, jw * e.by_thing});
    });
    s.cost += loss.value();
    return s;
  }

  WindowState stepped(const WindowSystem& s, const WindowState& state, const Eigen::VectorXd& step,
                      const std::vector<Eigen::Matrix3d>& inverses) const {
    WindowState next = state;
    for (std::size_t k = 0, column = 0; k < next.poses.size(); ++k) {
      if (!problem_.is_free[k]) continue;
      next.poses[k] = retract(state.poses[k], step.segment<6>(static_cast<Eigen::Index>(6 * column++)));
    }
    for (std::size_t i = 0; i < next.things.size(); ++i) {
      Eigen::Vector3d right = s.right[i];
      for (const auto& [column, block] : s.coupling[i]) right -= block.transpose() * step.segment<6>(6 * column);
      next.things[i] += inverses[i] * right;
      next.things[i].z() = std::max(0.0, next.things[i].z());  // beyond infinity is nothing
    }
    return next;
  }

 private:
  double prior_cost(std::size_t i, const Eigen::Vector3d& theta) const {
    const Eigen::Vector3d off = theta - problem_.things[i].prior;
    return off.dot(problem_.things[i].information * off);
  }

  // A place times its inverse depth is w = ray + inverse depth * centre of its frame, and a camera sees it at
  // R w + inverse depth * t. What is not in front of it is as wrong as can be, and says nothing of where to go.
  template <class Visit>
  void for_each(const WindowState& state, Visit visit) const {
    constexpr double kWhereBehind = 1e4, kLeastDepth = 1e-3;
    std::vector<Eigen::Matrix3d> rotations;
    for (const Rigid3& pose : state.poses) rotations.push_back(pose.rotation.toRotationMatrix());
    Residual e;
    for (std::size_t i = 0; i < state.things.size(); ++i) {
      const double inverse_depth = state.things[i].z();
      const Eigen::Matrix3d frame = world_from_frame_[i].rotation.toRotationMatrix();
      const Eigen::Vector3d& origin = world_from_frame_[i].translation;
      const Eigen::Vector3d w =
          frame * Eigen::Vector3d(state.things[i].x(), state.things[i].y(), 1) + inverse_depth * origin;
      for (const Observation& o : seen_[i]) {
        const Eigen::Matrix3d& r = rotations[static_cast<std::size_t>(o.pose)];
        const Eigen::Vector3d& t = state.poses[static_cast<std::size_t>(o.pose)].translation;
        const Eigen::Vector3d x = r * w + inverse_depth * t;
        if (x.z() < kLeastDepth) {
          visit(i, nullptr, e, kWhereBehind);
          continue;
        }
        const Eigen::Matrix<double, 2, 3> j = o.whiten * problem_.camera->project_jacobian(x);
        e.r = o.whiten * (o.px - problem_.camera->project(x));
        e.by_pose.leftCols<3>().noalias() = -j * skew(x);
        e.by_pose.rightCols<3>() = inverse_depth * j;
        e.by_thing.leftCols<2>().noalias() = j * (r * frame.leftCols<2>());
        e.by_thing.col(2).noalias() = j * (r * origin + t);
        visit(i, &o, e, e.r.squaredNorm());
      }
    }
  }

  const WindowProblem& problem_;
  int free_ = 0;
  std::vector<Rigid3> world_from_frame_;
  std::vector<std::vector<Observation>> seen_;
};

std::vector<Eigen::Matrix3d> damped_inverses(const WindowSystem& s, double lambda) {
  std::vector<Eigen::Matrix3d> out;
  for (Eigen::Matrix3d block : s.thing_blocks) {
    block.diagonal() *= 1 + lambda;
    block.diagonal().array() += 1e-12 * (1e-12 + block.trace());
    out.emplace_back(block.inverse());
  }
  return out;
}

// What is left when the things are taken out speaks of the poses alone.
Eigen::VectorXd step_of_poses(const WindowSystem& s, const std::vector<Eigen::Matrix3d>& inverses, double lambda) {
  Eigen::MatrixXd a = s.a;
  Eigen::VectorXd b = s.b;
  for (std::size_t i = 0; i < s.thing_blocks.size(); ++i) {
    for (const Coupling& c : s.coupling[i]) {
      const Matrix63 left = c.block * inverses[i];
      b.segment<6>(6 * c.column) -= left * s.right[i];
      for (const Coupling& d : s.coupling[i]) {
        if (d.column <= c.column) a.block<6, 6>(6 * c.column, 6 * d.column) -= left * d.block.transpose();
      }
    }
  }
  a.diagonal() *= 1 + lambda;
  return a.selfadjointView<Eigen::Lower>().ldlt().solve(b);
}

}  // namespace

WindowResult solve_window(const WindowProblem& problem, int max_iterations) {
  constexpr double kSettled = 1e-5;
  const Solver solver(problem);
  WindowState state = solver.start();
  WindowSystem s = solver.build(state);
  WindowResult result;
  result.cost_before = s.cost;
  result.iterations = levenberg_marquardt({}, max_iterations, [&](double lambda) {
    const auto inverses = damped_inverses(s, lambda);
    const Eigen::VectorXd step = step_of_poses(s, inverses, lambda);
    if (!step.allFinite()) return LmStep::kImpossible;
    const WindowState next = solver.stepped(s, state, step, inverses);
    WindowSystem t = solver.build(next);
    if (!(t.cost <= s.cost)) return LmStep::kFailed;
    const bool settled = s.cost - t.cost < kSettled * s.cost;
    state = next;
    s = std::move(t);
    return settled ? LmStep::kConverged : LmStep::kImproved;
  });
  result.cam_from_world = std::move(state.poses);
  result.theta = std::move(state.things);
  result.cost = s.cost;
  return result;
}

bool set_known(const Eigen::Vector3d& position, const Eigen::Matrix3d& covariance, WindowThing* thing) {
  const Eigen::Vector3d x = thing->frame_from_world * position;
  constexpr double kLeast = 1e-6;
  if (x.z() < kLeast) return false;
  const double z = 1 / x.z();
  Eigen::Matrix3d j;
  j << z, 0, -x.x() * z * z, 0, z, -x.y() * z * z, 0, 0, -z * z;
  j *= thing->frame_from_world.rotation.toRotationMatrix();
  Eigen::Matrix3d spread = j * covariance * j.transpose();
  spread.diagonal().array() += 1e-12;
  thing->theta = thing->prior = {x.x() * z, x.y() * z, z};
  thing->information = spread.inverse();
  return thing->information.allFinite();
}

Eigen::Vector4d place_of(const Rigid3& frame_from_world, const Eigen::Vector3d& theta) {
  const Rigid3 world_from_frame = frame_from_world.inverse();
  Eigen::Vector4d place;
  place << world_from_frame.rotation * Eigen::Vector3d(theta.x(), theta.y(), 1) +
               theta.z() * world_from_frame.translation,
      theta.z();
  return place;
}

bool set_start(const Eigen::Vector4d& place, WindowThing* thing) {
  constexpr double kLeast = 1e-3;
  const Rigid3& frame = thing->frame_from_world;
  const Eigen::Vector3d x = frame.rotation * place.head<3>() + place.w() * frame.translation;
  if (x.z() <= kLeast) return false;
  thing->theta = {x.x() / x.z(), x.y() / x.z(), place.w() / x.z()};
  return true;
}

}  // namespace coslam
