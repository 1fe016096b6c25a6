// Times pinocchio's C++ on the serial chain from standard input; one JSON line for each thing timed.
//
//     pinocchio_kinematics NAME < chain
//
// A line for each joint, then one for the tip: the joint's kind (X, Y, Z: turns about that axis), parent_from_child by rows
// (12 numbers: rotation beside translation). The tip's kind is T. Configurations as in benches/lib.rs.
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/multibody.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

using Pin = pinocchio::Model;

static Pin read_chain(std::istream & in)
{
  Pin model;
  pinocchio::JointIndex parent = 0;
  std::string kind;
  while (in >> kind)
  {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    for (int row = 0; row < 3; ++row)
      in >> rotation(row, 0) >> rotation(row, 1) >> rotation(row, 2) >> translation(row);
    const pinocchio::SE3 placement(rotation, translation);
    const std::string name = "joint" + std::to_string(parent);
    if (kind == "X") parent = model.addJoint(parent, pinocchio::JointModelRX(), placement, name);
    else if (kind == "Y") parent = model.addJoint(parent, pinocchio::JointModelRY(), placement, name);
    else if (kind == "Z") parent = model.addJoint(parent, pinocchio::JointModelRZ(), placement, name);
    else model.addFrame(pinocchio::Frame("tip", parent, 0, placement, pinocchio::OP_FRAME));
  }
  return model;
}

template<typename Work>
static void report(const char * name, const char * what, const std::vector<Eigen::VectorXd> & configurations, Work work)
{
  std::vector<double> times;
  for (int repetition = 0; repetition < 300; ++repetition)
  {
    const auto start = std::chrono::steady_clock::now();
    for (const auto & q : configurations) work(q);
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
    times.push_back(time.count() / configurations.size());
  }
  std::sort(times.begin(), times.end());
  std::printf("{\"who\": \"%s\", \"what\": \"%s\", \"ns\": %.2f}\n", name, what, times[times.size() / 2]);
}

int main(int, char ** arguments)
{
  const Pin model = read_chain(std::cin);
  pinocchio::Data data(model);
  const auto tip = model.getFrameId("tip");
  std::vector<Eigen::VectorXd> configurations;
  for (int i = 0, k = 1; i < 1000; ++i)
  {
    Eigen::VectorXd q(model.nq);
    for (int j = 0; j < model.nq; ++j, ++k) q[j] = 6.0 * std::fmod(k * 0.6180339887498949, 1.0) - 3.0;
    configurations.push_back(q);
  }
  volatile double sink = 0.0;
  report(arguments[1], "fk", configurations, [&](const Eigen::VectorXd & q) {
    pinocchio::forwardKinematics(model, data, q);
    pinocchio::updateFramePlacement(model, data, tip);
    sink = data.oMf[tip].translation()[0];
  });
  pinocchio::Data::Matrix6x columns = pinocchio::Data::Matrix6x::Zero(6, model.nv);
  report(arguments[1], "jacobian", configurations, [&](const Eigen::VectorXd & q) {
    pinocchio::computeFrameJacobian(model, data, q, tip, pinocchio::LOCAL_WORLD_ALIGNED, columns);
    sink = columns(0, 0);
  });
  // For checks: the tip at the last configuration.
  pinocchio::forwardKinematics(model, data, configurations.back());
  const auto at = pinocchio::updateFramePlacement(model, data, tip).translation();
  std::fprintf(stderr, "%.15g %.15g %.15g\n", at[0], at[1], at[2]);
}
