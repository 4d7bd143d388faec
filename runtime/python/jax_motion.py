"""A motion as a function that JAX differentiates: y = motion(y0, p), forwards by lagc's batch, backwards by its reverse mode.

    motion = jax_motion.of(lagc.load("@double_pendulum"), "swing", times=[0.5, 1.0])
    jax.grad(lambda p: (motion(y0, p)[-1] ** 2).sum())(p)  # by all parameters; SI units, in the order of m.parameters()
"""
import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)


def of(model, scene, times, **how):
    times = np.asarray(times, dtype=float)
    like = lambda x: jax.ShapeDtypeStruct(x, jnp.float64)

    def run(y0, p):
        return model.batch(scene, y0=np.asarray(y0)[None], p=np.asarray(p)[None], times=times, method="dop853", **how).y[0]

    def back(y0, p, weight):
        g = model.gradient(lambda t, y: (0.0, np.asarray(weight)), scene, y0=y0, p=p, times=times, **how)
        return g.by_start, g.by_p

    @jax.custom_vjp
    def motion(y0, p):
        return jax.pure_callback(run, like((len(times), y0.shape[0])), y0, p)

    def backward(kept, weight):
        y0, p = kept
        return jax.pure_callback(back, (like(y0.shape), like(p.shape)), y0, p, weight)

    motion.defvjp(lambda y0, p: (motion(y0, p), (y0, p)), backward)
    return motion
