// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/model/rig.h"

#include <cmath>
#include <sstream>

#include "common/base/error.h"

namespace coslam {

std::string text_of(const RigCamera& camera) {
  const Eigen::Vector3d& t = camera.cam_from_first.translation;
  const Eigen::Quaterniond& q = camera.cam_from_first.rotation;
  std::ostringstream out;
  out.precision(17);
  out << camera.camera << ' ' << camera.first;
  for (const double v : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) out << ' ' << v;
  return out.str();
}

Rigid3 rig_transform(const std::vector<double>& numbers) {
  const auto& v = numbers;
  if (v.size() != 7) throw UserError("a transform is x y z qx qy qz qw, seven numbers");
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  const Eigen::Vector3d t(v[0], v[1], v[2]);
  if (!t.allFinite() || !(std::abs(q.norm() - 1) < 0.01)) {
    throw UserError("a transform is x y z qx qy qz qw, the last four a quaternion of length 1");
  }
  if (!(t.norm() > 1e-6)) throw UserError("two cameras of a rig are not at one place");
  return {q.normalized(), t};
}

RigCamera parse_rig_camera(std::string_view text) {
  std::istringstream in{std::string(text)};
  RigCamera out;
  in >> out.camera >> out.first;
  std::vector<double> numbers;
  for (double v = 0; in >> v;) numbers.push_back(v);
  if (out.first.empty() || !in.eof()) {
    throw UserError("'" + std::string(text) + "' is not CAMERA FIRST x y z qx qy qz qw");
  }
  if (out.camera == out.first) throw UserError("a rig has '" + out.camera + "' twice");
  out.cam_from_first = rig_transform(numbers);
  return out;
}

}  // namespace coslam
