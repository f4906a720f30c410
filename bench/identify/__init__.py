"""Stiffness, counterbalance and friction from measured data, with Pinocchio and without any simulator."""
