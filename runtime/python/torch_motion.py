"""A motion as a function that PyTorch differentiates: y = Motion.apply(model, scene, times, y0, p), in SI units.

    y = torch_motion.Motion.apply(lagc.load("@double_pendulum"), "swing", [0.5, 1.0], y0, p)
    (y[-1] ** 2).sum().backward()                          # p.grad: by all parameters, in the order of m.parameters()
"""
import numpy as np
import torch


class Motion(torch.autograd.Function):
    @staticmethod
    def forward(context, model, scene, times, y0, p):
        times = np.asarray(times, dtype=float)
        context.save_for_backward(y0, p)
        context.motion = model, scene, times
        arrays = {"y0": y0.detach().double().numpy()[None], "p": p.detach().double().numpy()[None]}
        return torch.from_numpy(model.batch(scene, times=times, method="dop853", **arrays).y[0])

    @staticmethod
    def backward(context, weight):
        model, scene, times = context.motion
        y0, p = (x.detach().double().numpy() for x in context.saved_tensors)
        g = model.gradient(lambda t, y: (0.0, weight.double().numpy()), scene, y0=y0, p=p, times=times)
        return None, None, None, torch.from_numpy(g.by_start), torch.from_numpy(g.by_p)
