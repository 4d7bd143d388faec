# Derivatives of closed-form motions, with 40 digits, for run_sensitivity.sh: python3 reference.py
from mpmath import *
mp.dps=40
def drive(m,k,A,F0,nu,x0=None,v0=None,t=mpf(7)):
    w=sqrt(k/m); x0=A if x0 is None else x0; v0=A*w/2 if v0 is None else v0
    C=F0/m/(w*w-nu*nu)
    x=C*sin(nu*t)+x0*cos(w*t)+(v0-C*nu)/w*sin(w*t)
    v=C*nu*cos(nu*t)-x0*w*sin(w*t)+(v0-C*nu)*cos(w*t)
    return x,v,F0*sin(nu*t)
def ball(m,g,e,h,a,t=mpf('1.4')):
    t1=sqrt(2*(h-a)/g); v=e*g*t1; s=t-t1
    n=0
    while s>2*v/g: s-=2*v/g; v*=e; n+=1
    return a+v*s-g*s*s/2, v-g*s
def kick(m,k,T,J,t=mpf(3)):
    w=sqrt(k/m); x,v=mpf('0.2'),mpf('0.1'); n=int(t/T); 
    def fl(x,v,s): return x*cos(w*s)+v/w*sin(w*s), -x*w*sin(w*s)+v*cos(w*s)
    for i in range(n): x,v=fl(x,v,T); v+=J
    return fl(x,v,t-n*T)
def rub(w,R,x0,v0,t=mpf('3.5')):
    # exact stepping over half swings
    x,v=x0,v0
    while True:
        s=sign(v); c=-s*R/w**2  # centre
        # x=c+A cos(ph+w s)
        A=sqrt((x-c)**2+(v/w)**2); ph=atan2(-v/w,x-c)
        # time to v=0: sin(ph+ws)=0
        k=ceil(ph/pi); 
        T=(k*pi-ph)/w
        if T<1e-30: T=pi/w
        if T>=t: return c+A*cos(ph+w*t), -A*w*sin(ph+w*t)
        x=c+A*cos(ph+w*T); t-=T
        if abs(x)*w*w<=R: return x,mpf(0)
        v=-sign(x)*mpf(10)**-45
def der(f,args):
    for i in range(len(args)):
        def g(d): 
            b=list(args); b[i]=b[i]+d; return f(*b)
        h=mpf(10)**-12; 
        p,q,r,s=g(h),g(-h),g(2*h),g(-2*h)
        print(i,[nstr((8*(a-b)-(c-d))/(12*h),15) for a,b,c,d in zip(p,q,r,s)])
der(drive,[mpf(2),mpf(8),mpf('0.3'),mpf('0.5'),mpf('1.7')])
A=mpf('0.3'); w=mpf(2)
der(drive,[mpf(2),mpf(8),A,mpf('0.5'),mpf('1.7'),A,A*w/2])
der(ball,[mpf(1),mpf('9.81'),mpf('0.8'),mpf(2),mpf('0.1')])
der(kick,[mpf(2),mpf(8),mpf('0.7'),mpf('0.3')])
der(rub, [mpf(3), mpf('0.9'), mpf(1), mpf('-0.5')])
