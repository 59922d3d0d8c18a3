// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/solve/pose_graph.h"

#include <Eigen/CholmodSupport>
#include <Eigen/SVD>
#include <Eigen/SparseCore>
#include <cmath>

namespace coslam {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Keeps what no link reaches where it is.
constexpr double kPriorWeight = 1e-9;

// A node by the node that it is tied to in the end; itself when it is free.
struct Tied {
  int root = 0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();    // node_from_root
  double scale = 1;                                          // unit at the root for one at the node
  Eigen::Vector3d center_in_root = Eigen::Vector3d::Zero();  // in the root's unit
};

std::vector<Tied> resolve(const PoseGraph& graph) {
  std::vector<const PoseGraph::Tie*> tie_of(graph.nodes.size(), nullptr);
  for (const PoseGraph::Tie& t : graph.ties) tie_of[static_cast<std::size_t>(t.node)] = &t;
  std::vector<Tied> out(graph.nodes.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    Tied& tied = out[i];
    tied.root = static_cast<int>(i);
    while (const PoseGraph::Tie* t = tie_of[static_cast<std::size_t>(tied.root)]) {
      // The node as `to` sees it, from how the tied node sees it.
      const Eigen::Matrix3d to_from_node = t->node_from_to.rotation.conjugate().toRotationMatrix();
      tied.center_in_root = to_from_node * (t->scale * tied.center_in_root) + t->node_from_to.center();
      tied.rotation = tied.rotation * to_from_node.transpose();
      tied.scale *= t->scale;
      tied.root = t->to;
    }
  }
  return out;
}

// Index of each free root among the unknowns; -1 for fixed and tied nodes.
std::vector<int> unknowns_of(const PoseGraph& graph, const std::vector<Tied>& tied, int* count) {
  std::vector<int> index(graph.nodes.size(), -1);
  *count = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (!graph.nodes[i].fixed && tied[i].root == static_cast<int>(i)) index[i] = (*count)++;
  }
  return index;
}

class Factor {
 public:
  Factor(int size, const Triplets& triplets) {
    Sparse a(size, size);
    a.setFromTriplets(triplets.begin(), triplets.end());
    factor_.cholmod().print = 0;  // ok() says it
    factor_.compute(a);
  }
  bool ok() const { return factor_.info() == Eigen::Success; }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const { return factor_.solve(b); }

 private:
  Eigen::CholmodDecomposition<Sparse, Eigen::Lower> factor_;
};

// Residuals x_a - M x_b - r of weight w between blocks of `kBlock` rows, x of a fixed block given.
template <int kBlock>
class Normal {
 public:
  using Square = Eigen::Matrix<double, kBlock, kBlock>;
  Normal(int unknowns, int columns) : rhs_(Eigen::MatrixXd::Zero(unknowns * kBlock, columns)) {}

  void prior(int a, const Eigen::MatrixXd& x) {
    diagonal(a, kPriorWeight);
    rhs_.middleRows(a * kBlock, kBlock) += kPriorWeight * x;
  }
  // a, b: unknowns, or -1 with the fixed value in xa, xb.
  void link(int a, int b, const Square& m, double w, const Eigen::MatrixXd& r, const Eigen::MatrixXd& xa,
            const Eigen::MatrixXd& xb) {
    if (a >= 0) {
      diagonal(a, w);
      rhs_.middleRows(a * kBlock, kBlock) += w * (b >= 0 ? r : Eigen::MatrixXd(m * xb + r));
    }
    if (b >= 0) {
      diagonal(b, w);  // M is a rotation
      rhs_.middleRows(b * kBlock, kBlock) -= w * m.transpose() * (a >= 0 ? r : Eigen::MatrixXd(r - xa));
    }
    if (a < 0 || b < 0) return;
    const bool below = a > b;  // the lower half only
    for (int i = 0; i < kBlock; ++i) {
      for (int j = 0; j < kBlock; ++j) {
        below ? triplets_.emplace_back(a * kBlock + i, b * kBlock + j, -w * m(i, j))
              : triplets_.emplace_back(b * kBlock + j, a * kBlock + i, -w * m(i, j));
      }
    }
  }
  bool solve(Eigen::MatrixXd* x) const {
    if (rhs_.rows() == 0) return true;
    const Factor factor(static_cast<int>(rhs_.rows()), triplets_);
    if (!factor.ok()) return false;
    *x = factor.solve(rhs_);
    return x->allFinite();
  }

 private:
  void diagonal(int a, double w) {
    for (int i = 0; i < kBlock; ++i) triplets_.emplace_back(a * kBlock + i, a * kBlock + i, w);
  }

  Triplets triplets_;
  Eigen::MatrixXd rhs_;
};

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

struct Problem {
  const PoseGraph& graph;
  std::vector<Tied> tied;
  std::vector<int> unknown;
  int unknowns = 0;

  const Rigid3& pose(int i) const { return graph.nodes[static_cast<std::size_t>(i)].cam_from_world; }
  const Tied& tie(int i) const { return tied[static_cast<std::size_t>(i)]; }
  int unknown_of(int i) const { return unknown[static_cast<std::size_t>(tie(i).root)]; }
  // Links between two nodes that do not move against each other anyway say nothing.
  bool idle(const PoseGraph::Link& l) const {
    return tie(l.first).root == tie(l.second).root || (unknown_of(l.first) < 0 && unknown_of(l.second) < 0);
  }
};

// (16)
bool solve_rotations(const Problem& p, std::vector<Eigen::Matrix3d>* rotations) {
  Normal<3> normal(p.unknowns, 3);
  for (std::size_t i = 0; i < p.unknown.size(); ++i) {
    if (p.unknown[i] >= 0) normal.prior(p.unknown[i], p.pose(static_cast<int>(i)).rotation.toRotationMatrix());
  }
  for (const PoseGraph::Link& l : p.graph.links) {
    if (p.idle(l)) continue;
    const Tied &a = p.tie(l.first), &b = p.tie(l.second);
    const Eigen::Matrix3d first_from_second =
        (p.pose(l.first).rotation * p.pose(l.second).rotation.conjugate()).toRotationMatrix();
    normal.link(p.unknown_of(l.first), p.unknown_of(l.second), a.rotation.transpose() * first_from_second * b.rotation,
                l.weight, Eigen::Matrix3d::Zero(), p.pose(a.root).rotation.toRotationMatrix(),
                p.pose(b.root).rotation.toRotationMatrix());
  }
  Eigen::MatrixXd x;
  if (!normal.solve(&x)) return false;
  rotations->resize(p.unknown.size());
  for (std::size_t i = 0; i < rotations->size(); ++i) {
    const int u = p.unknown_of(static_cast<int>(i));
    const Eigen::Matrix3d root =
        u >= 0 ? nearest_rotation(x.middleRows<3>(3 * u)) : p.pose(p.tied[i].root).rotation.toRotationMatrix();
    (*rotations)[i] = p.tied[i].rotation * root;
  }
  return true;
}

// Logarithms of the scales.
bool solve_scales(const Problem& p, std::vector<double>* scales) {
  Normal<1> normal(p.unknowns, 1);
  using One = Eigen::Matrix<double, 1, 1>;
  const One zero = One::Zero();
  for (const int u : p.unknown) {
    if (u >= 0) normal.prior(u, zero);
  }
  for (const PoseGraph::Link& l : p.graph.links) {
    if (p.idle(l)) continue;
    const One between(std::log(p.tie(l.second).scale) - std::log(p.tie(l.first).scale));
    normal.link(p.unknown_of(l.first), p.unknown_of(l.second), One::Ones(), l.weight, between, zero, zero);
  }
  Eigen::MatrixXd x;
  if (!normal.solve(&x)) return false;
  scales->resize(p.unknown.size());
  for (std::size_t i = 0; i < scales->size(); ++i) {
    const int u = p.unknown_of(static_cast<int>(i));
    (*scales)[i] = p.tied[i].scale * std::exp(u >= 0 ? x(u, 0) : 0.0);
  }
  return true;
}

// (17), for the camera centres: the residual in the world instead of in the camera, of the same length.
bool solve_centers(const Problem& p, const std::vector<Eigen::Matrix3d>& rotations, const std::vector<double>& scales,
                   std::vector<Eigen::Vector3d>* centers) {
  const auto at = [](const auto& all, int i) { return all[static_cast<std::size_t>(i)]; };
  const auto from_root = [&](int i) {
    const Tied& t = p.tie(i);
    return Eigen::Vector3d(at(scales, t.root) * (at(rotations, t.root).transpose() * t.center_in_root));
  };
  Normal<1> normal(p.unknowns, 3);
  for (std::size_t i = 0; i < p.unknown.size(); ++i) {
    if (p.unknown[i] >= 0) normal.prior(p.unknown[i], p.pose(static_cast<int>(i)).center().transpose());
  }
  for (const PoseGraph::Link& l : p.graph.links) {
    if (p.idle(l)) continue;
    const Rigid3& first = p.pose(l.first);
    const Eigen::Vector3d second_in_first = first * p.pose(l.second).center();
    const double scale = std::sqrt(at(scales, l.first) * at(scales, l.second));
    // center(first) - center(second)
    const Eigen::Vector3d apart = -scale * (at(rotations, l.first).transpose() * second_in_first);
    const Eigen::Vector3d r = apart - from_root(l.first) + from_root(l.second);
    normal.link(p.unknown_of(l.first), p.unknown_of(l.second), Eigen::Matrix<double, 1, 1>::Ones(), l.weight,
                r.transpose(), p.pose(p.tie(l.first).root).center().transpose(),
                p.pose(p.tie(l.second).root).center().transpose());
  }
  Eigen::MatrixXd x;
  if (!normal.solve(&x)) return false;
  centers->resize(p.unknown.size());
  for (std::size_t i = 0; i < centers->size(); ++i) {
    const int node = static_cast<int>(i), u = p.unknown_of(node);
    const Eigen::Vector3d root = u >= 0 ? Eigen::Vector3d(x.row(u).transpose()) : p.pose(p.tied[i].root).center();
    (*centers)[i] = root + from_root(node);
  }
  return true;
}

}  // namespace

PoseGraphSolution solve_path_graph(const PoseGraph& graph) {
  Problem p{graph, resolve(graph), {}, 0};
  p.unknown = unknowns_of(graph, p.tied, &p.unknowns);
  PoseGraphSolution out;
  std::vector<Eigen::Matrix3d> rotations;
  std::vector<double> scales;
  std::vector<Eigen::Vector3d> centers;
  if (!solve_rotations(p, &rotations) || !solve_scales(p, &scales) || !solve_centers(p, rotations, scales, &centers))
    return out;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const Rigid3& before = graph.nodes[i].cam_from_world;
    PoseGraphSolution::Corrected c;
    c.scale = scales[i];
    c.cam_from_world.rotation = Eigen::Quaterniond(rotations[i]).normalized();
    c.cam_from_world.translation = -(c.cam_from_world.rotation * centers[i]);
    c.new_from_old.scale = c.scale;
    c.new_from_old.rotation = (c.cam_from_world.rotation.conjugate() * before.rotation).normalized();
    c.new_from_old.translation = centers[i] - c.scale * (c.new_from_old.rotation * before.center());
    out.nodes.push_back(c);
  }
  out.ok = true;
  return out;
}

}  // namespace coslam
